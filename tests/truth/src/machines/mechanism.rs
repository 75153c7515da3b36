//! Machines as data: bodies and stores, and the elements between them, that both the truth and the unit are made of.

/// A number that the unit has as a parameter.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// What is true.
    pub value: f64,
    /// What the unit starts from.
    pub start: f64,
}

/// What drives the machine, or is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
}

/// What a sensor shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sensor {
    /// A state, by index.
    State(usize),
    /// The rate of a state: an acceleration.
    Rate(usize),
    /// Force of an element, by index.
    Force(usize),
}

/// One element. Indices of bodies, stores (`body`, `from`, `to`: see [`Machine`]), inputs and parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs)] // indices, as said
pub enum Element {
    /// k (x_from - x_to), towards the other; to the ground where `to` is none.
    Spring { from: usize, to: Option<usize>, stiffness: usize },
    /// k_3 (x_from - x_to)^3
    Cubic { from: usize, to: Option<usize>, stiffness: usize },
    /// c (v_from - v_to)
    Damper { from: usize, to: Option<usize>, damping: usize },
    /// c (v_from - v_to) |v_from - v_to|
    Orifice { from: usize, to: Option<usize>, damping: usize },
    /// -G sin x
    Gravity { body: usize, moment: usize },
    /// A force that is an input.
    Push { body: usize, input: usize },
    /// A spring whose other end is an input.
    Shaken { body: usize, input: usize, stiffness: usize },
    /// L di/dt = u - R i - K w; the body gets K i.
    Motor { body: usize, current: usize, input: usize, inductance: usize, resistance: usize, constant: usize },
    /// T dp/dt = u - p; the body gets A p.
    Cylinder { body: usize, pressure: usize, input: usize, time: usize, area: usize },
    /// C dh/dt gets the input.
    Inflow { store: usize, input: usize },
    /// q = G (h_from - h_to)
    Conductance { from: usize, to: Option<usize>, conductance: usize },
    /// q = a sqrt(2 g h_from)
    Outlet { from: usize, to: Option<usize>, area: usize },
}

/// A machine. States are positions of the bodies, their velocities, then all others; stores are states of their own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Machine {
    /// Numbers of the unit.
    pub parameters: Vec<Parameter>,
    /// Per body its parameter of inertia.
    pub bodies: Vec<usize>,
    /// Per store its parameter of capacity. Stores come before other states.
    pub stores: Vec<usize>,
    /// Number of other states: currents, pressures.
    pub others: usize,
    /// What is between them.
    pub elements: Vec<Element>,
    /// Inputs.
    pub inputs: Vec<Variable>,
    /// Outputs, and what they show.
    pub outputs: Vec<(Variable, Sensor)>,
    /// Time that is natural for the machine \[s\].
    pub time: f64,
}

/// Acceleration of free fall \[m/s2\].
pub const GRAVITY: f64 = 9.81;

/// What is hidden in the equations of motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Influence {
    /// Force on each body.
    pub force: Vec<f64>,
    /// Flow into each store.
    pub flow: Vec<f64>,
}

impl Machine {
    /// Number of states.
    #[must_use]
    pub fn states(&self) -> usize {
        2 * self.bodies.len() + self.stores.len() + self.others
    }

    /// Index of the velocity of a body.
    #[must_use]
    pub fn velocity(&self, body: usize) -> usize {
        self.bodies.len() + body
    }

    /// Index of the state of a store.
    #[must_use]
    pub fn store(&self, store: usize) -> usize {
        2 * self.bodies.len() + store
    }

    /// Index of another state.
    #[must_use]
    pub fn other(&self, other: usize) -> usize {
        2 * self.bodies.len() + self.stores.len() + other
    }

    /// True values.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }

    /// What an element gives: a force on `from` or `body` against its deflection, a flow.
    #[must_use]
    pub fn effort(&self, element: Element, p: &[f64], u: &[f64], x: &[f64]) -> f64 {
        let between = |from: usize, to: Option<usize>| x[from] - to.map_or(0.0, |t| x[t]);
        let speed =
            |from: usize, to: Option<usize>| x[self.velocity(from)] - to.map_or(0.0, |t| x[self.velocity(t)]);
        let level = |store: usize| x[self.store(store)];
        match element {
            Element::Spring { from, to, stiffness } => p[stiffness] * between(from, to),
            Element::Cubic { from, to, stiffness } => {
                let d = between(from, to);
                p[stiffness] * d * d * d
            }
            Element::Damper { from, to, damping } => p[damping] * speed(from, to),
            Element::Orifice { from, to, damping } => {
                let v = speed(from, to);
                p[damping] * v * v.abs()
            }
            Element::Gravity { body, moment } => p[moment] * libm::sin(x[body]),
            Element::Push { input, .. } => -u[input],
            Element::Shaken { body, input, stiffness } => p[stiffness] * (x[body] - u[input]),
            Element::Motor { current, constant, .. } => -p[constant] * x[self.other(current)],
            Element::Cylinder { pressure, area, .. } => -p[area] * x[self.other(pressure)],
            Element::Inflow { input, .. } => -u[input],
            Element::Conductance { from, to, conductance } => {
                p[conductance] * (level(from) - to.map_or(0.0, level))
            }
            Element::Outlet { from, area, .. } => p[area] * (2.0 * GRAVITY * level(from).max(0.0)).sqrt(),
        }
    }

    /// The body that an element pushes, and the one that it pushes the other way; none for stores.
    fn bodies_of(element: Element) -> Option<(usize, Option<usize>)> {
        match element {
            Element::Spring { from, to, .. }
            | Element::Cubic { from, to, .. }
            | Element::Damper { from, to, .. }
            | Element::Orifice { from, to, .. } => Some((from, to)),
            Element::Gravity { body, .. }
            | Element::Push { body, .. }
            | Element::Shaken { body, .. }
            | Element::Motor { body, .. }
            | Element::Cylinder { body, .. } => Some((body, None)),
            Element::Inflow { .. } | Element::Conductance { .. } | Element::Outlet { .. } => None,
        }
    }

    /// Rates of the states.
    pub fn slope(&self, p: &[f64], u: &[f64], x: &[f64], by: &Influence, dx: &mut [f64]) {
        let n = self.bodies.len();
        let mut force = by.force.clone();
        let mut flow = by.flow.clone();
        force.resize(n, 0.0);
        flow.resize(self.stores.len(), 0.0);
        dx.fill(0.0);
        for element in &self.elements {
            let effort = self.effort(*element, p, u, x);
            if let Some((from, to)) = Self::bodies_of(*element) {
                force[from] -= effort;
                if let Some(to) = to {
                    force[to] += effort;
                }
            }
            match *element {
                Element::Inflow { store, .. } => flow[store] -= effort,
                Element::Conductance { from, to, .. } | Element::Outlet { from, to, .. } => {
                    flow[from] -= effort;
                    if let Some(to) = to {
                        flow[to] += effort;
                    }
                }
                Element::Motor { body, current, input, inductance, resistance, constant } => {
                    let (i, w) = (x[self.other(current)], x[self.velocity(body)]);
                    dx[self.other(current)] =
                        (u[input] - p[resistance] * i - p[constant] * w) / p[inductance];
                }
                Element::Cylinder { pressure, input, time, .. } => {
                    dx[self.other(pressure)] = (u[input] - x[self.other(pressure)]) / p[time];
                }
                _ => {}
            }
        }
        for b in 0..n {
            dx[b] = x[n + b];
            dx[n + b] = force[b] / p[self.bodies[b]];
        }
        for s in 0..self.stores.len() {
            dx[self.store(s)] = flow[s] / p[self.stores[s]];
        }
    }

    /// States at rest with these inputs: zero, but for stores, through which the first input flows.
    #[must_use]
    pub fn start(&self, p: &[f64], u: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.states()];
        for element in self.elements.iter().rev() {
            match *element {
                Element::Conductance { from, to, conductance } => {
                    x[self.store(from)] = u[0] / p[conductance] + to.map_or(0.0, |t| x[self.store(t)]);
                }
                Element::Outlet { from, area, .. } => {
                    let speed = u[0] / p[area];
                    x[self.store(from)] = speed * speed / (2.0 * GRAVITY);
                }
                _ => {}
            }
        }
        x
    }

    /// What ideal sensors show.
    #[must_use]
    pub fn measure(&self, p: &[f64], u: &[f64], x: &[f64], by: &Influence) -> Vec<f64> {
        let mut dx = vec![0.0; x.len()];
        self.slope(p, u, x, by, &mut dx);
        let show = |sensor: Sensor| match sensor {
            Sensor::State(k) => x[k],
            Sensor::Rate(k) => dx[k],
            Sensor::Force(k) => self.effort(self.elements[k], p, u, x),
        };
        self.outputs.iter().map(|(_, sensor)| show(*sensor)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameter(name: &str, value: f64) -> Parameter {
        Parameter { name: name.into(), unit: "1", value, start: value }
    }

    /// m x'' + c x' + k x = F
    fn oscillator() -> Machine {
        Machine {
            parameters: vec![parameter("m", 2.0), parameter("k", 8.0), parameter("c", 0.5)],
            bodies: vec![0],
            elements: vec![
                Element::Spring { from: 0, to: None, stiffness: 1 },
                Element::Damper { from: 0, to: None, damping: 2 },
                Element::Push { body: 0, input: 0 },
            ],
            inputs: vec![Variable { name: "F".into(), unit: "N" }],
            outputs: vec![(Variable { name: "a".into(), unit: "m/s2" }, Sensor::Rate(1))],
            time: 0.5,
            ..Machine::default()
        }
    }

    #[test]
    fn newton_holds() {
        let machine = oscillator();
        let a = machine.measure(&machine.values(), &[3.0], &[0.5, -2.0], &Influence::default());
        assert_eq!(a, [(3.0 - 8.0 * 0.5 + 0.5 * 2.0) / 2.0]);
    }

    #[test]
    fn stores_start_where_what_comes_in_goes_out() {
        let machine = Machine {
            parameters: vec![
                parameter("A", 0.3),
                parameter("B", 0.2),
                parameter("a", 1e-3),
                parameter("b", 2e-3),
            ],
            stores: vec![0, 1],
            elements: vec![
                Element::Inflow { store: 0, input: 0 },
                Element::Outlet { from: 0, to: Some(1), area: 2 },
                Element::Outlet { from: 1, to: None, area: 3 },
            ],
            ..Machine::default()
        };
        let (p, u) = (machine.values(), [4e-3]);
        let x = machine.start(&p, &u);
        let mut dx = [1.0; 2];
        machine.slope(&p, &u, &x, &Influence::default(), &mut dx);
        assert!(dx.iter().all(|v| v.abs() < 1e-15), "{dx:?}");
        assert!((x[0] - 16.0 / 19.62).abs() < 1e-12, "{x:?}");
    }
}
