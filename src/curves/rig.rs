//! [`Rig`]: a flat track, model or FMU, that is brought into the states of conditions.

use super::{Condition, Point};
use crate::model::unit::Unit;
use crate::model::{Causality, Interface, Slave, Value};
use crate::recording::Names;
use crate::{Error, Result};

/// What runs until it is stationary is averaged over windows of this way of the wheel \[m\]: a turn of a passenger car's wheel, so that
/// what ripples with its elements is averaged as well.
const WINDOW: f64 = 2.1;
/// Two windows that differ by no more than this share of the load are those of a stationary state: no line of a picture is thinner.
/// Moments are over load and [`ARM`].
const SETTLED: f64 = 1e-3;
const ARM: f64 = 0.1;
/// No more windows than that are driven: 60 m, over which a tire with a relaxation length of 3 m comes within a millionth.
const WINDOWS: usize = 30;
/// Step of the slip angle behind which a relaxation length is read \[rad\]: half a degree, where tires are still linear.
const STEER: f64 = 0.5 * std::f64::consts::PI / 180.0;
/// The way after which the lateral force has this share of its change is the relaxation length: 1 - 1/e, as for a lag of first order.
const RELAXED: f64 = 1.0 - 0.367_879_441_171_442_33;
/// No longer way is looked at \[m\]: ten times what truck tires relax over.
const LONGEST: f64 = 30.0;
/// The deflection that carries a load is found to this share of it, or as well as a settled force is known.
const CARRIED: f64 = 1e-3;
const MAX_TRIALS: usize = 40;

/// A variable with its unit.
#[derive(Debug, Clone, Copy)]
struct Port {
    variable: usize,
    /// From SI to its unit, or back for what is read.
    factor: f64,
    offset: f64,
}

/// How the rig holds a load.
#[derive(Debug, Clone, Copy)]
enum Hold {
    Load(Port),
    Deflection(Port),
}

/// A tire on a flat track.
pub struct Rig {
    slave: Box<dyn Slave>,
    /// What every start is given first.
    fixed: Vec<(usize, Value)>,
    hold: Hold,
    speed: Option<Port>,
    friction: Option<Port>,
    slip_angle: Option<Port>,
    slip: Option<Port>,
    camber: Option<Port>,
    /// Forces and moments.
    outputs: [Option<Port>; 6],
    height: Option<Port>,
    deflection: Option<Port>,
    /// True where a start is a stationary state.
    tells: Option<usize>,
    /// What it starts with, if that is above 0: load \[N\] and speed \[m/s\].
    starts: [Option<f64>; 2],
    /// With which the last load was carried \[m\].
    carried: f64,
    warnings: Vec<String>,
}

/// A deflection that most tires carry something with: where the search begins \[m\].
const FIRST_DEFLECTION: f64 = 0.015;

impl Rig {
    /// A rig, with values that every run is given. `names` are what it calls the variables of the shipped flat tracks.
    ///
    /// # Errors
    /// It has no vertical force, or neither a load nor a deflection to hold; units that are not those of the quantities.
    pub fn new(slave: Box<dyn Slave>, values: &[(usize, Value)], names: &Names) -> Result<Self> {
        let interface = slave.interface().clone();
        let find = |name: &str, unit: &str, is_input: bool| port(&interface, names, name, unit, is_input);
        let hold = match (find("load", "N", true)?, find("deflection", "m", true)?) {
            (Some(load), _) => Hold::Load(load),
            (None, Some(deflection)) => Hold::Deflection(deflection),
            (None, None) => return Err(lacks(&interface, "input", "load or deflection")),
        };
        let forces = ["force_x", "force_y", "force_z"].map(|name| find(name, "N", false));
        let moments = ["moment_x", "moment_y", "moment_z"].map(|name| find(name, "N.m", false));
        let ([fx, fy, fz], [mx, my, mz]) = (forces, moments);
        let outputs = [fx?, fy?, fz?, mx?, my?, mz?];
        if outputs[2].is_none() {
            return Err(lacks(&interface, "output", "force_z"));
        }
        let mut fixed = values.to_vec();
        // what shipped rigs are asked for: the load is held, and commands are the motion
        for (name, value) in [("load_control", true), ("command_actuators", false)] {
            if let Some(variable) = interface.index(name).filter(|v| !fixed.iter().any(|(f, _)| f == v)) {
                fixed.push((variable, Value::Boolean(value)));
            }
        }
        let mut rig = Self {
            hold,
            speed: find("path_speed", "m/s", true)?,
            friction: find("friction_factor", "1", true)?,
            slip_angle: find("slip_angle", "rad", true)?,
            slip: find("slip", "1", true)?,
            camber: find("camber", "rad", true)?,
            outputs,
            height: find("wheel_centre_height", "m", false)?,
            deflection: find("actual_deflection", "m", false)?,
            tells: interface.index("stationary_start"),
            slave,
            fixed,
            starts: [None; 2],
            carried: FIRST_DEFLECTION,
            warnings: Vec::new(),
        };
        rig.starts = rig.starts_with(&interface)?;
        Ok(rig)
    }

    /// Load and speed that it has from its maker.
    fn starts_with(&mut self, interface: &Interface) -> Result<[Option<f64>; 2]> {
        self.begin()?;
        self.slave.start(0.0, None)?;
        let mut value = |port: Option<Port>| {
            let port = port?;
            let own = self.slave.get(port.variable).ok()?;
            Some((own - port.offset) / port.factor).filter(|value| *value > 0.0)
        };
        let held = match self.hold {
            Hold::Load(port) => value(Some(port)),
            Hold::Deflection(_) => None,
        };
        let speed = value(self.speed);
        // the load that the coefficients of a Magic Formula tire are for
        let nominal = interface.index("FNOMIN").and_then(|v| self.slave.get(v).ok());
        Ok([nominal.filter(|load| *load > 0.0).or(held), speed])
    }

    /// Whether it drives slip angle, slip and camber.
    pub(super) fn drives(&self) -> [bool; 3] {
        [self.slip_angle, self.slip, self.camber].map(|port| port.is_some())
    }

    /// Whether it drives speed and friction.
    pub(super) fn varies(&self) -> [bool; 2] {
        [self.speed, self.friction].map(|port| port.is_some())
    }

    /// The load that the model was made for, or starts with \[N\].
    pub fn nominal_load(&self) -> Option<f64> {
        self.starts[0]
    }

    /// The speed that it starts with \[m/s\].
    pub fn speed(&self) -> Option<f64> {
        self.starts[1]
    }

    /// What the model said of its starts, each once.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The same without what shipped rigs tell and others do not: whether a start is stationary, and a load that they hold.
    #[cfg(test)]
    pub(super) fn silent(mut self, is_pushed: bool) -> Self {
        self.tells = None;
        let interface = self.slave.interface().clone();
        if is_pushed {
            let find = |name: &str| port(&interface, &Names::new(), name, "m", true).unwrap().unwrap();
            self.hold = Hold::Deflection(find("deflection"));
            self.fixed.retain(|(variable, _)| interface.variables[*variable].name != "load_control");
        }
        self
    }

    /// What it measures in the stationary state of a condition: that in which it starts, if it says that it does; else it is driven until
    /// forces and moments no longer change.
    ///
    /// # Errors
    /// The condition cannot be held, the model leaves its validity, or nothing is stationary.
    pub fn point(&mut self, condition: &Condition) -> Result<Point> {
        self.hold(condition).map_err(|e| e.at(condition))
    }

    /// The way after which the lateral force has 63 % of its change behind a step of the slip angle of half a degree \[m\].
    ///
    /// # Errors
    /// As [`point`](Self::point); a lateral force that does not get there.
    pub fn relaxation_length(&mut self, condition: &Condition) -> Result<f64> {
        self.relax(condition).map_err(|e| e.at(condition))
    }

    fn hold(&mut self, condition: &Condition) -> Result<Point> {
        match self.hold {
            Hold::Load(port) => self.stationary(condition, port, condition.load),
            Hold::Deflection(port) => self.carry(condition, port),
        }
    }

    /// The stationary state with the deflection that carries the load, by the secant through the last two trials.
    fn carry(&mut self, condition: &Condition, port: Port) -> Result<Point> {
        let missing = |point: &Point| point.force[2] - condition.load;
        let mut at = self.carried;
        let mut point = self.stationary(condition, port, at)?;
        let (mut before, mut off_before) = (0.0, -condition.load);
        for _ in 0..MAX_TRIALS {
            let off = missing(&point);
            if off.abs() <= CARRIED * condition.load {
                self.carried = at;
                let deflection = point.deflection.or(Some(at));
                return Ok(Point { deflection, ..point });
            }
            let slope = (off - off_before) / (at - before);
            if !(slope.is_finite() && slope > 0.0) {
                break;
            }
            (before, off_before) = (at, off);
            at -= off / slope;
            point = self.stationary(condition, port, at)?;
        }
        Err(Error::numeric(format!(
            "no deflection was found with which the tire carries the load; the last was {at:.4} m, with {:.0} N",
            point.force[2]
        )))
    }

    fn begin(&mut self) -> Result<()> {
        self.slave.reset()?;
        self.fixed.iter().try_for_each(|(variable, value)| self.slave.set_value(*variable, value))
    }

    fn start(&mut self, condition: &Condition, held: Port, value: f64) -> Result<()> {
        self.begin()?;
        let conditions = [
            (self.speed, condition.speed),
            (self.friction, condition.friction),
            (self.slip_angle, condition.slip_angle),
            (self.slip, condition.slip),
            (self.camber, condition.camber),
            (Some(held), value),
        ];
        for (port, value) in conditions {
            if let Some(port) = port {
                port.set(self.slave.as_mut(), value)?;
            }
        }
        self.slave.start(0.0, None)?;
        self.slave.finish_start()?;
        if let Some(warning) = self.slave.warning()
            && !self.warnings.contains(&warning)
        {
            self.warnings.push(warning);
        }
        Ok(())
    }

    fn stationary(&mut self, condition: &Condition, held: Port, value: f64) -> Result<Point> {
        self.start(condition, held, value)?;
        let is_stationary = match self.tells {
            Some(variable) => self.slave.get(variable)? != 0.0,
            None => false,
        };
        if is_stationary { self.read() } else { Ok(self.settle(condition)?.0) }
    }

    /// Drives on until nothing changes; the mean over the last window, and the time \[s\].
    fn settle(&mut self, condition: &Condition) -> Result<(Point, f64)> {
        let step = self.slave.interface().communication_step;
        let steps = (WINDOW / (condition.speed * step)).ceil().max(1.0) as usize;
        let mut last: Option<Point> = None;
        let mut done = 0_usize;
        for _ in 0..WINDOWS {
            let mut sum = [0.0; 8];
            for _ in 0..steps {
                self.slave.step(done as f64 * step, step)?;
                done += 1;
                for (sum, value) in sum.iter_mut().zip(self.read()?.numbers()) {
                    *sum += value / steps as f64;
                }
            }
            let mean = Point::from_numbers(sum);
            if let Some(last) = last
                && mean.is_near(&last, condition.load)
            {
                return Ok((mean, done as f64 * step));
            }
            last = Some(mean);
        }
        Err(Error::numeric(format!(
            "forces and moments still change by more than {SETTLED} of the load after {:.0} m",
            WINDOW * WINDOWS as f64
        )))
    }

    fn read(&mut self) -> Result<Point> {
        let mut values = [0.0; 6];
        for (value, port) in values.iter_mut().zip(self.outputs) {
            if let Some(port) = port {
                *value = port.get(self.slave.as_mut())?;
            }
        }
        let [a, b, c, d, e, f] = values;
        let [height, deflection] = [self.height, self.deflection];
        let slave = self.slave.as_mut();
        Ok(Point {
            force: [a, b, c],
            moment: [d, e, f],
            height: height.map(|port| port.get(slave)).transpose()?,
            deflection: deflection.map(|port| port.get(slave)).transpose()?,
        })
    }

    fn relax(&mut self, condition: &Condition) -> Result<f64> {
        let steered = Condition { slip_angle: condition.slip_angle + STEER, ..*condition };
        let end = self.hold(&steered)?.force[1];
        let straight = self.hold(condition)?;
        let Some(port) = self.slip_angle else { return Err(Error::call("the rig has no slip angle")) };
        let step = self.slave.interface().communication_step;
        // it may be where a search or a window ended
        let is_stationary = self.tells.is_some_and(|v| self.slave.get(v).is_ok_and(|tells| tells != 0.0));
        let mut time = 0.0;
        if !is_stationary {
            let (held, value) = match self.hold {
                Hold::Load(port) => (port, condition.load),
                Hold::Deflection(port) => (port, self.carried),
            };
            self.start(condition, held, value)?;
            time = self.settle(condition)?.1;
        }
        let begin = straight.force[1];
        if (end - begin).abs() < SETTLED * condition.load {
            return Err(Error::numeric("a slip angle makes no lateral force"));
        }
        port.set(self.slave.as_mut(), steered.slip_angle)?;
        let (mut way, mut before) = (0.0, 0.0);
        while way < LONGEST {
            self.slave.step(time, step)?;
            time += step;
            let share = (self.read()?.force[1] - begin) / (end - begin);
            if share >= RELAXED {
                let last = (share - RELAXED) / (share - before);
                return Ok(way + condition.speed * step * (1.0 - last));
            }
            way += condition.speed * step;
            before = share;
        }
        Err(Error::numeric(format!("the lateral force had not relaxed after {LONGEST} m")))
    }
}

impl Port {
    fn set(self, slave: &mut dyn Slave, value: f64) -> Result<()> {
        slave.set(self.variable, value * self.factor + self.offset)
    }

    fn get(self, slave: &mut dyn Slave) -> Result<f64> {
        Ok(slave.get(self.variable)? * self.factor + self.offset)
    }
}

/// The variable that stands for one of the shipped rigs.
fn port(
    interface: &Interface,
    names: &Names,
    name: &str,
    unit: &str,
    is_input: bool,
) -> Result<Option<Port>> {
    let variable = match names.get(name) {
        Some(own) => interface.find(own).map_err(|e| e.at(format!("the name for {name}")))?,
        None => match interface.index(name) {
            Some(variable) => variable,
            None => return Ok(None),
        },
    };
    let info = &interface.variables[variable];
    if is_input && !matches!(info.causality, Causality::Input | Causality::Parameter) {
        return Err(Error::variable(format!("{} of {} cannot be set", info.name, interface.name)));
    }
    let own = info.unit.as_deref().unwrap_or(unit);
    let (from, to) = if is_input { (unit, own) } else { (own, unit) };
    let Some((factor, offset)) = Unit::parse(from)?.to(Unit::parse(to)?) else {
        return Err(Error::variable(format!(
            "{} of {} is in {own:?}, which is no unit of {name}, which is in {unit:?}",
            info.name, interface.name
        )));
    };
    Ok(Some(Port { variable, factor, offset }))
}

fn lacks(interface: &Interface, what: &str, names: &str) -> Error {
    Error::variable(format!(
        "{} has no {what} {names}: a flat track is needed, as ring-brush-flat-track; what a rig of somebody else calls them is said by --names",
        interface.name
    ))
}

impl Point {
    fn numbers(&self) -> [f64; 8] {
        let ([a, b, c], [d, e, f]) = (self.force, self.moment);
        [a, b, c, d, e, f, self.height.unwrap_or(f64::NAN), self.deflection.unwrap_or(f64::NAN)]
    }

    fn from_numbers([a, b, c, d, e, f, height, deflection]: [f64; 8]) -> Self {
        let there = |value: f64| Some(value).filter(|v| v.is_finite());
        Self { force: [a, b, c], moment: [d, e, f], height: there(height), deflection: there(deflection) }
    }

    fn is_near(&self, other: &Self, load: f64) -> bool {
        let near =
            |a: &[f64; 3], b: &[f64; 3], most: f64| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= most);
        near(&self.force, &other.force, SETTLED * load)
            && near(&self.moment, &other.moment, SETTLED * load * ARM)
    }
}
