//! What a report shows of an identification: characteristics as measured and as the model has them, and how targets depend on
//! parameters.

use super::estimate::{Estimate, Number, Point};
use super::evidence::Read;
use super::reduced::Known;
use super::search::Search;
use crate::Result;
use crate::identify::plan::Plan;
use crate::identify::readings::Readings;
use crate::identify::registry::Numbers;
use crate::identify::solve::Targets;
use serde::Serialize;

/// Places of a response.
const PLACES: usize = 11;
/// A response goes to so many half intervals, and to this share of the parameter at least, to each side.
const AROUND: [f64; 2] = [3.0, 0.25];

/// A quantity and its unit.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Quantity {
    /// What it is called.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

/// What was read of one quantity over another, and what the model has at the same inputs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Characteristic {
    /// What is varied.
    pub over: Quantity,
    /// What answers.
    pub of: Quantity,
    /// For each reading the place,
    pub at: Vec<f64>,
    /// what was measured there, less its offset,
    pub measured: Vec<f64>,
    /// and what the model has, with the parameters found.
    pub modelled: Vec<f64>,
}

/// How a target depends on the parameter that it fixes, all others as they were found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// The group.
    pub group: String,
    /// The parameter, as the plan looks for it.
    pub parameter: Quantity,
    /// Its value.
    pub value: f64,
    /// Half its interval by what scatters alone.
    pub half_width: f64,
    /// The target.
    pub target: String,
    /// Per cent by which the parameter moves for 1 % more of the target, when all other targets stay.
    pub amplification: f64,
    /// Values of the parameter,
    pub at: Vec<f64>,
    /// and of the target.
    pub reads: Vec<f64>,
}

impl Search<'_> {
    /// Characteristics of all that is read, one for each pair of quantities; means are shown over what was measured of the load.
    pub fn characteristics(&self, plan: &Plan) -> Result<Vec<Characteristic>> {
        let model = self.model(plan)?;
        let numbers = model.model_values(&model.sought_values(&self.numbers)?)?;
        let mut all: Vec<(Characteristic, Vec<usize>)> = Vec::new();
        for read in self.reads(plan)? {
            let Some((over, of)) = self.axes(plan, &read) else { continue };
            let (place, number) = (over, of);
            let simulated = self.simulated(&model, &read, &numbers)?;
            let (over, of) = (self.input(over), self.quantity(&number));
            let found = all.iter().position(|(c, _)| (&c.over, &c.of) == (&over, &of));
            let place_of = found.unwrap_or(all.len());
            if found.is_none() {
                let empty = || Vec::new();
                let characteristic =
                    Characteristic { over, of, at: empty(), measured: empty(), modelled: empty() };
                all.push((characteristic, Vec::new()));
            }
            let Some((shown, members)) = all.get_mut(place_of) else { continue };
            for ((member, measured), modelled) in
                read.members.iter().zip(self.evidence.points(&read)).zip(&simulated)
            {
                if members.contains(member) {
                    continue;
                }
                members.push(*member);
                shown.at.push(measured.inputs[place] - self.offsets[place]);
                shown.measured.push(number.of(&measured));
                shown.modelled.push(number.of(modelled));
            }
        }
        Ok(all.into_iter().map(|(characteristic, _)| characteristic).collect())
    }

    /// The input over which a reading is shown, and what is shown.
    fn axes(&self, plan: &Plan, read: &Read) -> Option<(usize, Number)> {
        Some(match &read.estimate {
            Estimate::Slope { output, along, .. } => (*along, Number::Output(*output)),
            Estimate::Odd { output, over, .. } => (*over, Number::Output(*output)),
            Estimate::FromTouch { number, over, .. } => (*over, number.clone()),
            Estimate::Mean(number) => {
                (self.evidence.signals.measured_by(plan).iter().position(Option::is_some)?, number.clone())
            }
        })
    }

    fn input(&self, place: usize) -> Quantity {
        let (name, variable) = &self.evidence.signals.inputs[place];
        self.named(name, Some(*variable))
    }

    fn quantity(&self, number: &Number) -> Quantity {
        match number {
            Number::Output(output) => {
                let (name, variable) = &self.evidence.signals.outputs[*output];
                self.named(name, Some(*variable))
            }
            Number::Functional { functional, outputs, .. } => {
                let variable = outputs.first().map(|o| self.evidence.signals.outputs[*o].1);
                self.named(functional.name, variable)
            }
        }
    }

    fn named(&self, name: &str, variable: Option<usize>) -> Quantity {
        let variable = variable.map(|v| &self.stand.interface().variables[v]);
        let unit = variable.and_then(|v| v.unit.clone()).unwrap_or_else(|| "1".into());
        Quantity { name: name.to_owned(), unit }
    }

    /// For each parameter that a plan looks for, the target of its group that fixes it most, around what was found.
    pub fn responses(&self, plan: &Plan, known: &Known) -> Result<Vec<Response>> {
        let model = self.model(plan)?;
        let reads = self.reads(plan)?;
        let at = model.sought_values(&self.numbers)?;
        let variance = known.variance();
        let inverse = known.jacobian.clone().try_inverse();
        let mut responses = Vec::new();
        let mut from = 0;
        for group in &plan.groups {
            let own = from..from + group.parameters.len();
            for (k, parameter) in own.clone().zip(&group.parameters) {
                let certain =
                    |row: &usize| (known.jacobian[(*row, k)] / known.covariance[(*row, *row)].sqrt()).abs();
                let Some(row) = own.clone().max_by(|a, b| certain(a).total_cmp(&certain(b))) else {
                    continue;
                };
                let half_width = variance.as_ref().map_or(f64::NAN, |v| known.side * v[(k, k)].sqrt());
                let (places, reads_there) = self.response(&model, &reads[row], &at, k, half_width)?;
                let measured = self.measured(&reads[row])?;
                responses.push(Response {
                    group: group.name.clone(),
                    parameter: self.named(&parameter.name, self.stand.interface().index(&parameter.name)),
                    value: at[k],
                    half_width,
                    target: reads[row].name.clone(),
                    amplification: inverse.as_ref().map_or(f64::NAN, |i| i[(k, row)] * measured / at[k]),
                    at: places,
                    reads: reads_there,
                });
            }
            from = own.end;
        }
        Ok(responses)
    }

    /// A target over the k-th parameter; not a number where the model cannot be.
    fn response(
        &self,
        model: &Readings<'_>,
        read: &Read,
        at: &[f64],
        k: usize,
        half_width: f64,
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let [low, high] = model.bounds()[k];
        let side = (AROUND[0] * half_width).max(AROUND[1] * at[k].abs());
        let [low, high] = [(at[k] - side).max(low), (at[k] + side).min(high)];
        let places: Vec<f64> =
            (0..PLACES).map(|i| low + (high - low) * i as f64 / (PLACES - 1) as f64).collect();
        let mut values = Vec::new();
        for place in &places {
            let mut moved = at.to_vec();
            moved[k] = *place;
            let numbers: Numbers = model.model_values(&moved)?;
            let points: Result<Vec<Point>> = self.simulated(model, read, &numbers);
            values.push(points.map_or(f64::NAN, |points| read.factor * read.estimate.of(&points)));
        }
        Ok((places, values))
    }
}
