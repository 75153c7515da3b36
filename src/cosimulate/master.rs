//! The master: starts the components, exchanges values, and takes them through one interval.

use super::energy::Bond;
use super::system::{Port, System};
use crate::model::Snapshot;
use crate::{Error, Result};

/// Outputs that differ by less than this share between two exchanges have settled.
const SETTLED: f64 = 1e-12;
/// More exchanges than this, and one for each component, are not made during initialization.
const MAX_EXCHANGES: usize = 200;
/// An iterated interval has converged when no exchanged value changes by more than this share.
const CONVERGED: f64 = 1e-10;
/// An interval is not halved more often than this: each halving is a level of recursion, and a component that
/// refuses a billionth of the interval has a fault that shorter ones do not cure.
const MAX_HALVINGS: u32 = 30;
/// An interval is not cut into more parts than this.
const MAX_PARTS: usize = 4096;

/// How the components of a system are coupled.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coupling {
    /// Indices of all components in the order in which they are stepped: those that come later get the
    /// outputs that the earlier ones have at the *end* of the interval (Gauss-Seidel; Mack 2009,
    /// section 5.6: the controller first). `None`: all get the outputs at its beginning (Jacobi).
    pub order: Option<Vec<usize>>,
    /// How often an interval is repeated at most, from saved states and with the outputs at its end, until
    /// the exchanged values agree. 0: each interval is run once.
    pub iterate: usize,
    /// How often an interval is halved at most, from saved states, when a component refuses a step. More
    /// than 30 are taken for 30, and an interval is cut into 4096 parts at most.
    pub halvings: u32,
}

/// One step of a component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Index of the component.
    pub component: usize,
    /// Its time before the step \[s\].
    pub from: f64,
    /// Its time after it \[s\].
    pub to: f64,
}

/// What a connection carries.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Flow {
    /// The output at the beginning of the last interval but one.
    before: f64,
    /// The output at the beginning of the interval.
    now: f64,
    /// The output at its end, as far as known.
    next: f64,
    /// What the input got: at the beginning and at the end of the interval.
    pub applied: (f64, f64),
    /// What is added to the output on its way.
    added: f64,
}

impl Flow {
    /// The output at the beginning and at the end of the interval.
    pub fn sent(&self) -> (f64, f64) {
        (self.now, self.next)
    }
}

/// What the master remembers between intervals.
#[derive(Default)]
pub(super) struct Exchange {
    /// One for each connection.
    pub flows: Vec<Flow>,
    /// What belongs to each component.
    links: Links,
    /// When each component's turn is; the same for all where none waits for another.
    rank: Vec<usize>,
    /// What the recorded inputs had at the end of the interval.
    pub fed: Vec<f64>,
    /// Length of the last interval \[s\].
    last_length: f64,
    /// Whether all components save and restore their states.
    can_roll_back: bool,
    /// How often intervals are halved at most; 0 where a component cannot vary its step.
    halvings: u32,
    /// Into how many more parts the present interval may be cut.
    parts_left: usize,
    /// Saved states, by depth of halving and component.
    saved: Vec<Vec<Snapshot>>,
    /// Intervals that were repeated as often as allowed and did not converge.
    pub unconverged: usize,
    /// Intervals that were halved.
    pub halved: usize,
    /// The turns of all components, if somebody wants to know.
    pub log: Option<Vec<Turn>>,
}

/// What belongs to each component, so that nothing is looked for in every interval.
#[derive(Default)]
struct Links {
    /// The connections to it.
    to: Vec<Vec<usize>>,
    /// The connections from it.
    from: Vec<Vec<usize>>,
    /// The recorded inputs of it.
    feeds: Vec<Vec<usize>>,
    /// The connections of each bond: of the effort and of the motion.
    bonds: Vec<Option<(usize, usize)>>,
}

impl Links {
    fn of(system: &System) -> Self {
        let by = |components: &mut dyn Iterator<Item = usize>| {
            let mut lists = vec![Vec::new(); system.components.len()];
            components.enumerate().for_each(|(i, component)| lists[component].push(i));
            lists
        };
        let wire = |to: Port| system.wires.iter().position(|w| w.to == to);
        Self {
            to: by(&mut system.wires.iter().map(|w| w.to.component)),
            from: by(&mut system.wires.iter().map(|w| w.from.component)),
            feeds: by(&mut system.feeds.iter().map(|f| f.to.component)),
            bonds: system.bonds.iter().map(|b| Some((wire(b.effort.to)?, wire(b.motion.to)?))).collect(),
        }
    }
}

/// What the master has to know to go on from saved states.
pub(super) struct Memory {
    flows: Vec<Flow>,
    fed: Vec<f64>,
    last_length: f64,
    bonds: Vec<Bond>,
}

impl System {
    /// Initializes all components, exchanging outputs until they settle, and checks that communication
    /// every `interval` seconds suits them.
    ///
    /// # Errors
    /// A component that does not start, or an interval that does not suit one. Outputs that do not
    /// settle are a [warning](System::warnings).
    pub fn start(&mut self, start: f64, stop: Option<f64>, interval: f64) -> Result<()> {
        self.begin(start, stop)?;
        self.settle()?;
        self.finish(interval)
    }

    /// Begins initialization.
    pub(super) fn begin(&mut self, start: f64, stop: Option<f64>) -> Result<()> {
        self.check_order()?;
        for component in &mut self.components {
            component.slave.start(start, stop).map_err(|e| e.at(&component.name))?;
        }
        for feed in &self.feeds {
            let component = &mut self.components[feed.to.component];
            component.slave.set(feed.to.variable, feed.at(start)).map_err(|e| e.at(&component.name))?;
        }
        let place =
            |c: usize| self.coupling.order.iter().flatten().position(|other| *other == c).unwrap_or(0);
        self.exchange = Exchange {
            flows: vec![Flow::default(); self.wires.len()],
            rank: (0..self.components.len()).map(place).collect(),
            fed: self.feeds.iter().map(|f| f.at(start)).collect(),
            links: Links::of(self),
            log: self.exchange.log.take(),
            ..Exchange::default()
        };
        Ok(())
    }

    /// Ends initialization, once the exchanged outputs have settled.
    pub(super) fn finish(&mut self, interval: f64) -> Result<()> {
        for component in &mut self.components {
            component.slave.finish_start().map_err(|e| e.at(&component.name))?;
        }
        for component in &self.components {
            if let Some(warning) = component.slave.warning() {
                self.warnings.push(format!("{}: {warning}", component.name));
            }
        }
        self.check_interval(interval)?;
        for i in 0..self.wires.len() {
            let value = self.read(i)?;
            let applied = self.wires[i].map(value);
            self.exchange.flows[i] =
                Flow { before: value, now: value, next: value, applied: (applied, applied), added: 0.0 };
        }
        for bond in &mut self.bonds {
            if let Some(i) = self.wires.iter().position(|w| w.to == bond.motion.to) {
                bond.reset(self.exchange.flows[i].applied.0);
            }
        }
        self.exchange.halvings = self.coupling.halvings.min(MAX_HALVINGS);
        if self.coupling.iterate > 0 || self.coupling.halvings > 0 {
            self.try_saving();
        }
        Ok(())
    }

    /// The order names every component once.
    pub(super) fn check_order(&self) -> Result<()> {
        let Some(order) = &self.coupling.order else { return Ok(()) };
        for (i, component) in self.components.iter().enumerate() {
            let times = order.iter().filter(|c| **c == i).count();
            if times != 1 {
                return Err(Error::file(format!(
                    "the order has to name every component once; {:?} is named {times} times",
                    component.name
                )));
            }
        }
        Ok(())
    }

    /// Exchanges outputs during initialization until they stop changing.
    pub(super) fn settle(&mut self) -> Result<()> {
        let exchanges = MAX_EXCHANGES + self.components.len();
        // the exchange in which each output changed last
        let mut changed = vec![0; self.wires.len()];
        for exchange in 1..=exchanges {
            let values = (0..self.wires.len()).map(|i| self.read(i)).collect::<Result<Vec<f64>>>()?;
            for (i, value) in values.into_iter().enumerate() {
                let last = std::mem::replace(&mut self.exchange.flows[i].now, value);
                if exchange == 1 || (value - last).abs() > SETTLED * value.abs().max(last.abs()) {
                    changed[i] = exchange;
                }
            }
            if changed.iter().all(|last| *last < exchange) {
                return Ok(());
            }
            for (wire, flow) in self.wires.iter().zip(&self.exchange.flows) {
                let component = &mut self.components[wire.to.component];
                let at =
                    |e: Error| e.at(format!("exchange {exchange} of the initialization: {}", component.name));
                component.slave.set(wire.to.variable, wire.map(flow.now)).map_err(at)?;
            }
        }
        // on its way round a loop a value comes by all components
        let recently = exchanges - 2 * self.components.len().min(MAX_EXCHANGES / 2);
        let names: Vec<String> = (0..self.wires.len())
            .filter(|i| changed[*i] >= recently)
            .map(|i| self.name(self.wires[i].from))
            .collect();
        self.warnings.push(format!(
            "the components do not agree on a start: after {exchanges} exchanges these outputs still change: {}; they depend on each other without delay (an algebraic loop), and the run begins with the values of the last exchange",
            names.join(", ")
        ));
        Ok(())
    }

    /// Finds out whether all components can save their states.
    fn try_saving(&mut self) {
        let halving = self.exchange.halvings > 0;
        if let Some(component) = self.components.iter().find(|c| halving && c.even_steps_only) {
            self.warnings.push(format!("{} cannot vary its step: intervals are not halved", component.name));
            self.exchange.halvings = 0;
        }
        let mut unable = Vec::new();
        for component in &mut self.components {
            if component.slave.save().is_err() {
                unable.push(component.name.as_str());
            }
        }
        self.exchange.can_roll_back = unable.is_empty();
        if !unable.is_empty() {
            self.warnings.push(format!(
                "{} cannot save and restore {} state: intervals are neither repeated nor halved",
                unable.join(", "),
                if unable.len() == 1 { "its" } else { "their" }
            ));
        }
    }

    /// Takes all components from `time` by `length` seconds.
    ///
    /// # Errors
    /// A component that refuses the step, also in the shortest interval that is allowed.
    pub fn advance(&mut self, time: f64, length: f64) -> Result<()> {
        self.exchange.parts_left = MAX_PARTS;
        self.interval(time, length, 0)
    }

    fn interval(&mut self, time: f64, length: f64, depth: u32) -> Result<()> {
        let saving =
            self.exchange.can_roll_back && (self.coupling.iterate > 0 || depth < self.exchange.halvings);
        if saving {
            self.save(depth as usize)?;
        }
        match self.passes(time, length, depth as usize) {
            Err(error) if saving && depth < self.exchange.halvings => {
                if self.exchange.parts_left < 2 {
                    return Err(error.at(format!("in one of {MAX_PARTS} parts of the interval")));
                }
                self.restore(depth as usize)?;
                self.exchange.halved += 1;
                self.exchange.parts_left -= 1;
                let half = 0.5 * length;
                self.interval(time, half, depth + 1)?;
                return self.interval(time + half, length - half, depth + 1);
            }
            done => done?,
        }
        let Exchange { flows, links, .. } = &self.exchange;
        for (bond, wires) in self.bonds.iter_mut().zip(&links.bonds) {
            if let Some((effort, motion)) = *wires {
                bond.add(&flows[effort], &flows[motion], length);
            }
        }
        for flow in &mut self.exchange.flows {
            (flow.before, flow.now) = (flow.now, flow.next);
        }
        self.exchange.last_length = length;
        Ok(())
    }

    /// One interval, repeated until the exchanged values agree.
    fn passes(&mut self, time: f64, length: f64, depth: usize) -> Result<()> {
        self.pass(time, length, false)?;
        if self.coupling.iterate == 0 || !self.exchange.can_roll_back {
            return Ok(());
        }
        for _ in 0..self.coupling.iterate {
            let last: Vec<f64> = self.exchange.flows.iter().map(|f| f.next).collect();
            self.restore(depth)?;
            self.pass(time, length, true)?;
            let agree = self.exchange.flows.iter().zip(last).all(|(flow, last)| {
                let size = flow.next.abs().max(flow.now.abs());
                (flow.next - last).abs() <= CONVERGED * size
            });
            if agree {
                return Ok(());
            }
        }
        self.exchange.unconverged += 1;
        Ok(())
    }

    /// Steps every component once. `repeated`: the outputs at the end of the interval are known from the
    /// last pass.
    fn pass(&mut self, time: f64, length: f64, repeated: bool) -> Result<()> {
        for position in 0..self.components.len() {
            let index = self.coupling.order.as_ref().map_or(position, |order| order[position]);
            self.set_inputs(index, time, length, repeated)
                .and_then(|()| self.components[index].slave.step(time, length))
                .map_err(|e| e.at(&self.components[index].name))?;
            for k in 0..self.exchange.links.from[index].len() {
                let wire = self.exchange.links.from[index][k];
                self.exchange.flows[wire].next = self.read(wire)?;
            }
            if let Some(log) = &mut self.exchange.log {
                log.push(Turn { component: index, from: time, to: time + length });
            }
        }
        Ok(())
    }

    fn set_inputs(&mut self, index: usize, time: f64, length: f64, repeated: bool) -> Result<()> {
        let slave = self.components[index].slave.as_mut();
        let interpolates = slave.can_interpolate();
        let Exchange { flows, links, rank, fed, can_roll_back, last_length, .. } = &mut self.exchange;
        let iterates = self.coupling.iterate > 0 && *can_roll_back;
        for i in &links.to[index] {
            let (wire, flow) = (&self.wires[*i], &mut flows[*i]);
            let earlier = rank[wire.from.component] < rank[index];
            let (begin, end) = match (repeated, wire.real) {
                (true, true) if interpolates => (flow.now, flow.next),
                (true, true) => {
                    let mean = 0.5 * (flow.now + flow.next);
                    (mean, mean)
                }
                _ => match (wire.derivative, earlier) {
                    (false, false) => (flow.now, flow.now),
                    (false, true) => (flow.next, flow.next),
                    (true, true) => (flow.now, flow.next),
                    (true, false) if *last_length > 0.0 => {
                        let slope = (flow.now - flow.before) / *last_length;
                        (flow.now, flow.now + slope * length)
                    }
                    (true, false) => (flow.now, flow.now),
                },
            };
            let mut applied = (wire.map(begin), wire.map(end));
            if wire.derivative && !earlier && !repeated {
                // the source may be about to turn at the end of what the input accepts
                let info = &slave.interface().variables[wire.to.variable];
                let (min, max) = (info.min.unwrap_or(f64::MIN), info.max.unwrap_or(f64::MAX));
                applied.1 = applied.1.min(max).max(min);
            }
            flow.applied = applied;
            slave.set(wire.to.variable, applied.0)?;
            // also a rate of zero: what the input kept from the interval before is its own business
            if wire.derivative || (iterates && interpolates && wire.real) {
                slave.set_rate(wire.to.variable, (applied.1 - applied.0) / length)?;
            }
        }
        for i in &links.feeds[index] {
            let feed = &self.feeds[*i];
            let (begin, end) = match (feed.lead, feed.derivative) {
                (true, _) => (feed.at(time + length), feed.at(time + length)),
                (false, true) => (feed.at(time), feed.at(time + length)),
                (false, false) => (feed.at(time), feed.at(time)),
            };
            fed[*i] = end;
            slave.set(feed.to.variable, begin)?;
            if feed.derivative {
                slave.set_rate(feed.to.variable, (end - begin) / length)?;
            }
        }
        Ok(())
    }

    /// The output of a connection, as its component has it now, with what is added to it.
    fn read(&mut self, wire: usize) -> Result<f64> {
        let from = self.wires[wire].from;
        let component = &mut self.components[from.component];
        let value = component.slave.get(from.variable).map_err(|e| e.at(&component.name))?;
        // nothing leaves all bits, the sign of zero too
        let added = self.exchange.flows[wire].added;
        Ok(if added == 0.0 { value } else { value + added })
    }

    /// Between intervals: all connections of an output carry `change` more than it, from now on.
    pub(super) fn change_wires(&mut self, from: Port, change: f64) {
        for (wire, flow) in self.wires.iter().zip(&mut self.exchange.flows) {
            if wire.from == from && wire.real && flow.added != change {
                flow.now += change - flow.added;
                flow.added = change;
            }
        }
    }

    fn save(&mut self, depth: usize) -> Result<()> {
        let mut saved = std::mem::take(&mut self.exchange.saved);
        if saved.len() <= depth {
            saved.resize_with(depth + 1, Vec::new);
        }
        let done = self.save_components(&mut saved[depth]);
        self.exchange.saved = saved;
        done
    }

    fn restore(&mut self, depth: usize) -> Result<()> {
        let saved = std::mem::take(&mut self.exchange.saved);
        let done = self.restore_components(&saved[depth]);
        self.exchange.saved = saved;
        done
    }

    /// Saves the state of every component, in place of earlier ones.
    pub(super) fn save_components(&mut self, saved: &mut Vec<Snapshot>) -> Result<()> {
        for (i, component) in self.components.iter_mut().enumerate() {
            match saved.get_mut(i) {
                Some(snapshot) => component.slave.save_into(snapshot),
                None => component.slave.save().map(|snapshot| saved.push(snapshot)),
            }
            .map_err(|e| e.at(&component.name))?;
        }
        Ok(())
    }

    pub(super) fn restore_components(&mut self, saved: &[Snapshot]) -> Result<()> {
        for (component, snapshot) in self.components.iter_mut().zip(saved) {
            component.slave.restore(snapshot).map_err(|e| e.at(&component.name))?;
        }
        Ok(())
    }

    /// What the master remembers, beside the components' states.
    pub(super) fn memory(&self) -> Memory {
        Memory {
            flows: self.exchange.flows.clone(),
            fed: self.exchange.fed.clone(),
            last_length: self.exchange.last_length,
            bonds: self.bonds.clone(),
        }
    }

    /// Goes back to what the master remembered.
    pub(super) fn remember(&mut self, memory: &Memory) {
        self.exchange.flows.clone_from(&memory.flows);
        self.exchange.fed.clone_from(&memory.fed);
        self.exchange.last_length = memory.last_length;
        self.bonds.clone_from(&memory.bonds);
    }
}
