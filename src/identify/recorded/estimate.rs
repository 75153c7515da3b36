//! How a target is read from stretches, recorded or simulated: the same way for both.

use crate::identify::registry::Functional;
use nalgebra::{DMatrix, DVector};

/// A polynomial of this degree through a characteristic; what it leaves of it is the same for recording and model.
const DEGREE: usize = 2;

/// What is known of a stretch.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Inputs.
    pub inputs: Vec<f64>,
    /// Outputs.
    pub outputs: Vec<f64>,
}

/// A number that is read from a point.
#[derive(Clone)]
pub enum Number {
    /// An output.
    Output(usize),
    /// A function of outputs and inputs; of inputs that are not recorded, or parameters, the value.
    Functional {
        /// The function.
        functional: Functional,
        /// The outputs that it needs.
        outputs: Vec<usize>,
        /// The inputs that it needs, or values.
        inputs: Vec<Result<usize, f64>>,
    },
}

impl Number {
    /// The number.
    pub fn of(&self, point: &Point) -> f64 {
        match self {
            Self::Output(output) => point.outputs[*output],
            Self::Functional { functional, outputs, inputs } => {
                let outputs: Vec<f64> = outputs.iter().map(|o| point.outputs[*o]).collect();
                let inputs: Vec<f64> =
                    inputs.iter().map(|i| i.map_or_else(|v| v, |i| point.inputs[i])).collect();
                (functional.read)(&outputs, &inputs)
            }
        }
    }
}

/// How a target is read.
#[derive(Clone)]
pub enum Estimate {
    /// The mean over all points.
    Mean(Number),
    /// The slope of an output along an input, in the plane through all points.
    Slope {
        /// The output.
        output: usize,
        /// The input.
        along: usize,
        /// The inputs that vary among the points.
        varying: Vec<usize>,
        /// An output that stays what it is by another input.
        kept: Option<(usize, usize)>,
    },
    /// Of a characteristic over an input from where the tire touches the road, its value or slope at a distance from there.
    FromTouch {
        /// What the characteristic is of.
        number: Number,
        /// The input.
        over: usize,
        /// The distance.
        distance: f64,
        /// Whether the slope is meant.
        slope: bool,
        /// The value off the road.
        free: f64,
    },
    /// An odd function of an input, at a value of that input: what both signs have in common does not count.
    Odd {
        /// What is read.
        output: usize,
        /// The input.
        over: usize,
        /// The value.
        at: f64,
    },
}

impl Estimate {
    /// The target; not a number where the points do not tell.
    pub fn of(&self, points: &[Point]) -> f64 {
        match self {
            Self::Mean(number) => points.iter().map(|p| number.of(p)).sum::<f64>() / points.len() as f64,
            Self::Slope { output, along, varying, kept } => {
                let slope = |output: usize, along: usize| {
                    let values: Vec<f64> = points.iter().map(|p| p.outputs[output]).collect();
                    let place = varying.iter().position(|v| *v == along);
                    place.zip(plane(points, varying, &values)).map_or(f64::NAN, |(k, c)| c[k + 1])
                };
                let own = slope(*output, *along);
                match kept {
                    None => own,
                    Some((kept, by)) => own - slope(*output, *by) * slope(*kept, *along) / slope(*kept, *by),
                }
            }
            Self::FromTouch { distance, slope, .. } => {
                let Some([constant, b, a]) = self.characteristic(points) else { return f64::NAN };
                let x = self.touch(points) + distance;
                if *slope { b + 2.0 * a * x } else { (a * x + b) * x + constant }
            }
            Self::Odd { output, over, at } => {
                let squares: f64 = points.iter().map(|p| p.inputs[*over].powi(2)).sum();
                let both = [-1.0, 1.0].map(|side| {
                    let own = points.iter().filter(|p| p.inputs[*over] * side > 0.0);
                    own.clone().map(|p| p.outputs[*output]).sum::<f64>() / own.count() as f64
                });
                let size = (squares / points.len() as f64).sqrt();
                0.5 * (both[1] - both[0]) * at / size
            }
        }
    }
}

impl Estimate {
    /// Coefficients of the characteristic over the input, less the value off the road.
    fn characteristic(&self, points: &[Point]) -> Option<[f64; DEGREE + 1]> {
        let Self::FromTouch { number, over, free, .. } = self else { return None };
        let values: Vec<f64> = points.iter().map(|p| number.of(p) - free).collect();
        let x: Vec<f64> = points.iter().map(|p| p.inputs[*over]).collect();
        let design = DMatrix::from_fn(x.len(), DEGREE + 1, |i, k| x[i].powi(k as i32));
        let found = least_squares(design, &values)?;
        Some(std::array::from_fn(|k| found[k]))
    }

    /// Where the tire touches the road, by that characteristic: where the force begins to rise.
    pub fn touch(&self, points: &[Point]) -> f64 {
        let Some([constant, b, a]) = self.characteristic(points) else { return f64::NAN };
        -2.0 * constant / (b + (b * b - 4.0 * a * constant).sqrt())
    }

    /// All outputs where the inputs of the plane are 0.
    pub fn at_zero(&self, points: &[Point]) -> Vec<f64> {
        let outputs = points.first().map_or(0, |p| p.outputs.len());
        let Self::Slope { varying, .. } = self else { return vec![f64::NAN; outputs] };
        let value = |output: usize| {
            let values: Vec<f64> = points.iter().map(|p| p.outputs[output]).collect();
            plane(points, varying, &values).map_or(f64::NAN, |c| c[0])
        };
        (0..outputs).map(value).collect()
    }

    /// What the readings of one target are expected to depend on: columns of a linear model of what is left of them.
    pub fn design(&self, points: &[Point]) -> DMatrix<f64> {
        let input = |k: usize, over: usize| points[k].inputs[over];
        match self {
            Self::Mean(_) => DMatrix::from_element(points.len(), 1, 1.0),
            Self::Slope { varying, .. } => DMatrix::from_fn(points.len(), varying.len() + 1, |i, k| {
                k.checked_sub(1).map_or(1.0, |k| input(i, varying[k]))
            }),
            Self::FromTouch { over, .. } => {
                DMatrix::from_fn(points.len(), DEGREE + 1, |i, k| input(i, *over).powi(k as i32))
            }
            Self::Odd { over, .. } => {
                DMatrix::from_fn(points.len(), 2, |i, k| input(i, *over).powi(k as i32))
            }
        }
    }
}

/// Constant and slopes of the plane through values, over some inputs.
fn plane(points: &[Point], inputs: &[usize], values: &[f64]) -> Option<DVector<f64>> {
    let design = DMatrix::from_fn(points.len(), inputs.len() + 1, |i, k| match k.checked_sub(1) {
        None => 1.0,
        Some(k) => points[i].inputs[inputs[k]],
    });
    least_squares(design, values)
}

fn least_squares(mut design: DMatrix<f64>, values: &[f64]) -> Option<DVector<f64>> {
    // columns of like size
    let sizes: Vec<f64> = design.column_iter().map(|c| c.norm().max(f64::MIN_POSITIVE)).collect();
    for (mut column, size) in design.column_iter_mut().zip(&sizes) {
        column /= *size;
    }
    if design.nrows() < design.ncols() {
        return None;
    }
    let found = design.svd(true, true).solve(&DVector::from_column_slice(values), 1e-10).ok()?;
    Some(DVector::from_fn(found.len(), |k, _| found[k] / sizes[k]))
}
