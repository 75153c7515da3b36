//! Writes a system in the short form.

use super::energy::BondKind;
use super::plan::{Plan, PlannedConnection, PortName, Source};
use crate::model::Value;
use std::path::Path;
use toml::Table;
use toml::Value as Toml;

impl Plan {
    /// The system in the short form that [`parse_toml`](super::parse_toml) reads. Files have the names that `name`
    /// gives them.
    pub fn to_toml(&self, name: &dyn Fn(&Path) -> String) -> String {
        let mut file = Table::new();
        let mut put = |key: &str, value: Option<Toml>| {
            if let Some(value) = value {
                file.insert(key.into(), value);
            }
        };
        let count = |n: i64| (n != 0).then_some(Toml::Integer(n));
        put("start", self.start.map(Toml::Float));
        put("stop", self.stop.map(Toml::Float));
        put("step", self.step.map(Toml::Float));
        put("order", self.order.as_ref().map(|names| texts(names.iter().cloned())));
        put("iterate", count(self.iterate as i64));
        put("halvings", count(self.halvings.into()));
        put("record_every", count(self.record_every as i64));
        put("component", Some(self.components_table(name)));
        put("connect", Some(self.connections_table()));
        put("inputs", (!self.inputs.is_empty()).then(|| self.inputs_array(name)));
        put("bond", (!self.bonds.is_empty()).then(|| self.bonds_array()));
        file.to_string()
    }

    fn components_table(&self, name: &dyn Fn(&Path) -> String) -> Toml {
        let of = |component: &super::PlannedComponent| {
            let mut table = Table::new();
            match &component.source {
                Source::Model(model, parameters) => {
                    table.insert("model".into(), Toml::String(model.clone()));
                    if let Some(path) = parameters {
                        table.insert("parameters".into(), Toml::String(name(path)));
                    }
                }
                Source::Fmu(path) => {
                    table.insert("fmu".into(), Toml::String(name(path)));
                }
            }
            if !component.set.is_empty() {
                let set = component.set.iter().map(|a| (a.variable.clone(), value(&a.value)));
                table.insert("set".into(), Toml::Table(set.collect()));
            }
            (component.name.clone(), Toml::Table(table))
        };
        Toml::Table(self.components.iter().map(of).collect())
    }

    fn connections_table(&self) -> Toml {
        let mut table = Table::new();
        for connection in &self.connections {
            let all = table.entry(port(&connection.from)).or_insert_with(|| Toml::Array(Vec::new()));
            if let Toml::Array(all) = all {
                all.push(target(connection));
            }
        }
        Toml::Table(table)
    }

    fn inputs_array(&self, name: &dyn Fn(&Path) -> String) -> Toml {
        let of = |inputs: &super::PlannedInputs| {
            let mut connect = Table::new();
            for (channel, to) in &inputs.connect {
                let all = connect.entry(channel.clone()).or_insert_with(|| Toml::Array(Vec::new()));
                if let Toml::Array(all) = all {
                    all.push(Toml::String(port(to)));
                }
            }
            let mut table = Table::new();
            table.insert("file".into(), Toml::String(name(&inputs.file)));
            table.insert("connect".into(), Toml::Table(connect));
            table.insert("derivative".into(), Toml::Boolean(inputs.derivative));
            Toml::Table(table)
        };
        Toml::Array(self.inputs.iter().map(of).collect())
    }

    fn bonds_array(&self) -> Toml {
        let of = |bond: &super::PlannedBond| {
            let kind = match bond.kind {
                BondKind::Flow => "flow",
                BondKind::Displacement => "displacement",
            };
            let pairs = [("effort", &bond.effort), (kind, &bond.motion)];
            Toml::Table(
                pairs.map(|(key, name)| (key.to_owned(), Toml::String(port(name)))).into_iter().collect(),
            )
        };
        Toml::Array(self.bonds.iter().map(of).collect())
    }
}

fn target(connection: &PlannedConnection) -> Toml {
    let transfer = connection.transfer;
    let mut table = Table::new();
    table.insert("to".into(), Toml::String(port(&connection.to)));
    if let Some((factor, offset)) = transfer.linear {
        table.insert("factor".into(), Toml::Float(factor));
        table.insert("offset".into(), Toml::Float(offset));
    }
    for (key, is) in [("keep_units", transfer.keep_units), ("derivative", transfer.derivative)] {
        if is {
            table.insert(key.into(), Toml::Boolean(true));
        }
    }
    Toml::Table(table)
}

fn port(name: &PortName) -> String {
    format!("{}.{}", name.component, name.variable)
}

fn texts(all: impl Iterator<Item = String>) -> Toml {
    Toml::Array(all.map(Toml::String).collect())
}

fn value(value: &Value) -> Toml {
    match value {
        Value::Real(v) => Toml::Float(*v),
        Value::Integer(v) => Toml::Integer((*v).into()),
        Value::Boolean(v) => Toml::Boolean(*v),
        Value::Text(v) => Toml::String(v.clone()),
    }
}
