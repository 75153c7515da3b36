//! The table of a model's variables, put together from the rows of its parts.

use super::access::{Lens, Way};
use super::interface::{Value, VariableInfo};
use super::variable::{Row, Variable};
use crate::{Error, Result};
use std::collections::BTreeMap;
use std::marker::PhantomData;
use std::sync::Arc;

/// The way to a field that is a part: `lens!(wheels[i])`, inside `impl Model`.
#[macro_export]
macro_rules! lens {
    ($($path:tt)+) => {
        $crate::model::Lens::new(move |m: &Self| &m.$($path)+, move |m: &mut Self| &mut m.$($path)+)
    };
}

/// The variables of a model or of a part of one, in the order in which they are shown.
///
/// ```
/// # use latsch::model::{Table, input, output, parameter};
/// # use latsch::{lens, real};
/// # #[derive(Default)]
/// # struct Spring { stiffness: f64, force: f64 }
/// # #[derive(Default)]
/// # struct Machine { springs: [Spring; 2], travel: f64 }
/// impl Spring {
///     fn rows() -> Table<Self> {
///         Table::new([
///             parameter("stiffness", "N/m", real!(stiffness), 2e4, "Force over travel").range(1.0, 1e9),
///             output("force", "N", real!(force), "Force of the spring on the body"),
///         ])
///     }
/// }
/// impl Machine {
///     fn variables() -> Table<Self> {
///         Table::new([input("travel", "m", real!(travel), 0.0, "Travel of the body")])
///             .part("front.", lens!(springs[0]), Spring::rows())
///             .part("rear.", lens!(springs[1]), Spring::rows())
///     }
/// }
/// let names: Vec<String> = Machine::variables().rows().iter().map(|row| row.name().into()).collect();
/// assert_eq!(names, ["travel", "front.stiffness", "front.force", "rear.stiffness", "rear.force"]);
/// ```
pub struct Table<M: 'static> {
    rows: Vec<Row>,
    model: PhantomData<fn(&M)>,
}

impl<M: 'static> Table<M> {
    /// A table of these rows.
    pub fn new(rows: impl IntoIterator<Item = Variable<M>>) -> Self {
        Self::of(Vec::new()).and(rows)
    }

    fn of(rows: Vec<Row>) -> Self {
        Self { rows, model: PhantomData }
    }

    /// The same with further rows behind its own.
    #[must_use]
    pub fn and(mut self, rows: impl IntoIterator<Item = Variable<M>>) -> Self {
        for variable in rows {
            self.rows.push(variable.row);
        }
        self
    }

    /// The same with the rows of a part behind its own. Their names get the prefix: `"front_left."` where the
    /// part is there several times, `""` where names are to stay as the part has them.
    #[must_use]
    pub fn part<P>(mut self, prefix: &str, lens: Lens<M, P>, part: Table<P>) -> Self {
        append(&mut self.rows, part.rows, prefix, &lens.way);
        self
    }

    /// The same with one row changed: where a part has another start value, or words of the whole.
    #[must_use]
    pub fn with(mut self, name: &str, change: impl FnOnce(Variable<M>) -> Variable<M>) -> Self {
        match self.position(name) {
            Some(at) => {
                let row = self.rows.remove(at);
                self.rows.insert(at, change(Variable::of(row)).row);
            }
            None => debug_assert!(false, "there is no row {name}"),
        }
        self
    }

    /// The same with another start value of a row, if there is one of that name: where a whole knows what it is, but not which part it
    /// gets.
    #[must_use]
    pub fn starting_where_there(self, name: &str, start: impl Into<Value>) -> Self {
        if self.position(name).is_some() { self.with(name, |row| row.start(start)) } else { self }
    }

    /// The parameters only.
    #[must_use]
    pub fn only_parameters(mut self) -> Self {
        self.rows.retain(Row::is_parameter);
        self
    }

    /// The same without parameters: where several parts share theirs.
    #[must_use]
    pub fn without_parameters(mut self) -> Self {
        self.rows.retain(|row| !row.is_parameter());
        self
    }

    /// The same without a row: where a part does not need what it has alone.
    #[must_use]
    pub fn without(mut self, name: &str) -> Self {
        self.rows.retain(|row| row.name() != name);
        self
    }

    /// The same with all real outputs [without a derivative](Variable::without_derivative), if `ragged`: where parts that come and
    /// go within a step make them.
    #[must_use]
    pub fn without_derivatives_if(mut self, ragged: bool) -> Self {
        if ragged {
            self.rows = self.rows.into_iter().map(Row::without_derivative).collect();
        }
        self
    }

    /// The rows.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The index of the row of that name.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.rows.iter().position(|row| row.name() == name)
    }

    /// Writes the start value of every row that has one.
    pub fn write_starts(&self, model: &mut M) {
        self.rows.iter().for_each(|row| row.write_start(model));
    }

    /// Writes a value that was [accepted](VariableInfo::accept) for row number `index`.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn write(&self, index: usize, model: &mut M, value: &Value) {
        self.rows[index].write(model, value);
    }

    /// The rows alone.
    pub(super) fn into_rows(self) -> Vec<Row> {
        self.rows
    }

    /// The rows as everything outside the model sees them. Where one of them says what it is, all of them are taken to: nothing is
    /// guessed of a model whose author has said it.
    pub(crate) fn infos(&self) -> Vec<VariableInfo> {
        infos(&self.rows)
    }

    /// Checks what the compiler cannot: that names and value references are unique, and that the rates of inputs are
    /// there.
    ///
    /// # Errors
    /// The first two rows that are one too many, or an input that runs on with something that is no row.
    pub(super) fn check(&self) -> Result<()> {
        check(&self.rows)
    }
}

// What does not need the model's type stands outside of what is compiled for each.

fn append(rows: &mut Vec<Row>, part: Vec<Row>, prefix: &str, way: &Arc<dyn Way>) {
    rows.extend(part.into_iter().map(|row| row.of_part(prefix, way)));
}

pub(super) fn infos(rows: &[Row]) -> Vec<VariableInfo> {
    let meaning = rows.iter().any(Row::has_meaning);
    rows.iter().map(|row| row.info(meaning)).collect()
}

fn check(rows: &[Row]) -> Result<()> {
    let mut seen: BTreeMap<u32, &str> = BTreeMap::new();
    for row in rows {
        let name = row.name();
        match seen.insert(reference(name), name) {
            Some(other) if other == name => {
                return Err(Error::variable(format!("the table has two variables called {name:?}")));
            }
            Some(other) => {
                return Err(Error::variable(format!(
                    "the variables {other:?} and {name:?} have the same value reference, which is made of the name; give one of them another name"
                )));
            }
            None => {}
        }
        if let Some(rate) = row.natural_rate()
            && !rows.iter().any(|row| row.name() == rate)
        {
            return Err(Error::variable(format!(
                "{name} runs on with {rate:?}, which is no variable of the table"
            )));
        }
    }
    Ok(())
}

/// The FMI value reference of a variable: a number made of its name (FNV-1a, 31 bits, because some masters keep it as a
/// signed number). So it stays when rows are moved or put between others. Two of 500 names share one with a
/// probability of 6e-5; the table then refuses them.
pub(crate) fn reference(name: &str) -> u32 {
    let hash =
        name.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    (hash ^ (hash >> 31)) & 0x7fff_ffff
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{input, local, output, parameter};
    use crate::real;

    #[derive(Default)]
    struct Wheel {
        speed: f64,
        angle: f64,
    }

    #[derive(Default)]
    struct Car {
        wheels: [Wheel; 2],
        mass: f64,
    }

    impl Wheel {
        fn rows() -> Table<Self> {
            Table::new([
                input("angle", "rad", real!(angle), 0.5, "Angle").runs_on("speed"),
                input("speed", "rad/s", real!(speed), 1.0, "Speed"),
            ])
        }
    }

    impl Car {
        fn table() -> Table<Self> {
            let mut table = Table::new([parameter("mass", "kg", real!(mass), 2.0, "Mass")]);
            for (i, place) in ["left.", "right."].into_iter().enumerate() {
                table = table.part(place, lens!(wheels[i]), Wheel::rows());
            }
            table
        }
    }

    #[test]
    fn parts_are_reached_under_their_prefix() {
        let table = Car::table().with("right.speed", |row| row.start(3.0));
        table.check().unwrap();
        let mut car = Car::default();
        table.write_starts(&mut car);
        assert_eq!((car.mass, car.wheels[0].speed, car.wheels[1].speed), (2.0, 1.0, 3.0));
        assert_eq!(table.rows()[4].read(&car), Value::Real(3.0));
        table.write(2, &mut car, &Value::Real(4.0));
        assert_eq!((car.wheels[0].angle, car.wheels[0].speed, car.wheels[1].speed), (0.5, 4.0, 3.0));
        assert_eq!(table.rows()[3].natural_rate(), Some("right.speed"));
    }

    #[test]
    fn references_stay_when_rows_are_moved_and_are_those_of_the_published_hash() {
        let of = |table: &Table<Car>| {
            let mut all: Vec<(String, u32)> =
                table.infos().into_iter().map(|info| (info.name, info.reference)).collect();
            all.sort_unstable();
            all
        };
        let moved = Table::new([]).part("right.", lens_of(1), Wheel::rows());
        let moved = moved.and([parameter("mass", "kg", Car::mass(), 2.0, "Mass")]);
        let moved = moved.part("left.", lens_of(0), Wheel::rows());
        assert_eq!(of(&Car::table()), of(&moved));
        // FNV-1a of "a" and "foobar" as its authors give them, without the highest bit but for its trace
        assert_eq!(reference("a"), (0xe40c_292c & 0x7fff_ffff) ^ 1);
        assert_eq!(reference("foobar"), (0xbf9c_f968 & 0x7fff_ffff) ^ 1);
    }

    fn lens_of(i: usize) -> Lens<Car, Wheel> {
        Lens::new(move |car: &Car| &car.wheels[i], move |car: &mut Car| &mut car.wheels[i])
    }

    impl Car {
        fn mass() -> crate::model::Access<Self> {
            real!(mass)
        }
    }

    #[test]
    fn a_table_that_contradicts_itself_is_refused() {
        let twice = Wheel::rows().and([output("speed", "1", Wheel::speed(), "Again")]);
        assert!(twice.check().unwrap_err().to_string().contains("two variables called \"speed\""));
        let lost = Table::new([input("angle", "rad", Wheel::speed(), 0.0, "Angle").runs_on("rate")]);
        assert!(lost.check().unwrap_err().to_string().contains("runs on with \"rate\""));
    }

    impl Wheel {
        fn speed() -> crate::model::Access<Self> {
            real!(speed)
        }
    }

    #[test]
    fn one_row_that_says_what_it_is_speaks_for_all() {
        use crate::model::{Purpose, Role};
        let silent = Wheel::rows();
        assert!(silent.infos().iter().all(|info| info.meaning.is_none()));
        let said = Wheel::rows().and([local("turn", "rad", Wheel::speed(), "Turn").role(Role::WheelAngle)]);
        let meanings: Vec<_> = said.infos().into_iter().map(|info| info.meaning.unwrap()).collect();
        assert_eq!(meanings[2].role, Some(Role::WheelAngle));
        assert_eq!((meanings[0].role, meanings[0].purpose), (None, Purpose::Physics));
    }
}
