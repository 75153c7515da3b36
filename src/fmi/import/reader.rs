//! Reads modelDescription.xml.

use super::description::{ANNOTATIONS, Capabilities, Description, Experiment};
use super::xml::{self, Element, Place};
use crate::model::{Causality, Initial, Interface, Kind, Meaning, Value, Variability, VariableInfo};
use crate::{Error, Result};
use std::collections::{HashMap, HashSet};

/// A longer modelDescription.xml is refused \[bytes\].
pub const MAX_LENGTH: u64 = 64 << 20;
/// Communication step of an FMU that names none \[s\].
const COMMUNICATION_STEP: f64 = 1e-3;
/// Length of the experiment of an FMU that names none \[s\].
const EXPERIMENT_LENGTH: f64 = 1.0;
/// What variables take over from their types has no more bytes than this, all together: each variable has its own copy,
/// so a short file could ask for any amount. It is four times the longest file.
const MAX_INHERITED: usize = 4 * MAX_LENGTH as usize;

impl Description {
    /// Reads the bytes of a modelDescription.xml.
    ///
    /// # Errors
    /// [`Error::fmu`] with line and column: XML that is broken, too long or has a DOCTYPE; another
    /// version of FMI; no co-simulation; missing or wrong attributes; names that occur twice.
    pub fn parse(bytes: &[u8]) -> Result<Self> {
        if bytes.len() as u64 > MAX_LENGTH {
            return Err(Error::fmu(format!("modelDescription.xml has more than {MAX_LENGTH} bytes")));
        }
        let mut reader = Reader::default();
        xml::read(bytes, |path, element| reader.open(path, element))?;
        reader.finish()
    }
}

/// The attributes of the root.
struct Root {
    version: String,
    name: String,
    guid: String,
    description: String,
    tool: Option<String>,
}

/// What is known of a type definition, or of a variable beyond its type definition.
#[derive(Debug, Clone, Default)]
struct Traits {
    base: Option<Base>,
    unit: Option<String>,
    min: Option<f64>,
    max: Option<f64>,
    nominal: Option<f64>,
    items: Vec<Item>,
    /// What a copy of these takes \[bytes\].
    size: usize,
}

#[derive(Debug, Clone)]
struct Item {
    name: String,
    value: i32,
    description: String,
}

/// The five types of FMI 2.0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Base {
    Real,
    Integer,
    Boolean,
    String,
    Enumeration,
}

impl Base {
    fn of(element: &str) -> Option<Self> {
        Some(match element {
            "Real" => Self::Real,
            "Integer" => Self::Integer,
            "Boolean" => Self::Boolean,
            "String" => Self::String,
            "Enumeration" => Self::Enumeration,
            _ => return None,
        })
    }

    fn name(self) -> &'static str {
        match self {
            Self::Real => "Real",
            Self::Integer => "Integer",
            Self::Boolean => "Boolean",
            Self::String => "String",
            Self::Enumeration => "Enumeration",
        }
    }
}

/// A ScalarVariable as written: its types may be defined further down.
struct Row {
    place: Place,
    name: String,
    reference: u32,
    description: String,
    causality: Causality,
    variability: Option<Variability>,
    initial: Option<Initial>,
    declared: Option<String>,
    start: Option<Value>,
    traits: Traits,
}

#[derive(Default)]
struct Reader {
    root: Option<Root>,
    identifier: Option<String>,
    capabilities: Capabilities,
    experiment: Experiment,
    types: HashMap<String, usize>,
    /// The type definitions in the order of the file; the last one is being read.
    traits: Vec<Traits>,
    /// Names and values of the items of the enumeration that is being read.
    item_names: HashSet<String>,
    item_values: HashSet<i32>,
    rows: Vec<Row>,
    names: HashSet<String>,
    /// The annotations that are being read are those of this tool.
    own_annotations: bool,
    /// What the author of the model says of its variables, by name.
    meanings: Option<HashMap<String, Meaning>>,
}

impl Reader {
    /// Takes one element; `path` are the names of the elements around it.
    fn open(&mut self, path: &[String], element: &Element) -> Result<()> {
        let path: Vec<&str> = path.iter().map(String::as_str).collect();
        match (path.as_slice(), element.name()) {
            ([], "fmiModelDescription") => self.root(element),
            ([], other) => Err(element.wrong(&format!(
                "the outermost element is <{other}>; that of an FMU is <fmiModelDescription>"
            ))),
            ([_], "CoSimulation") => self.co_simulation(element),
            ([_], "DefaultExperiment") => {
                self.experiment = Experiment {
                    start: element.real("startTime")?,
                    stop: element.real("stopTime")?,
                    tolerance: element.real("tolerance")?,
                    step_size: element.real("stepSize")?,
                };
                if self.experiment.step_size.is_some_and(|h| h <= 0.0) {
                    return Err(element.wrong("the attribute stepSize has to be positive"));
                }
                Ok(())
            }
            ([_, "TypeDefinitions"], "SimpleType") => {
                let name = element.required("name")?;
                if self.types.insert(name.into(), self.traits.len()).is_some() {
                    return Err(element.wrong(&format!("the type {name:?} is defined twice")));
                }
                self.traits.push(Traits::default());
                Ok(())
            }
            ([_, "TypeDefinitions", "SimpleType"], name) => {
                if let (Some(base), Some(current)) = (Base::of(name), self.traits.last_mut()) {
                    *current = traits(element, base)?;
                    self.item_names.clear();
                    self.item_values.clear();
                }
                Ok(())
            }
            ([_, "TypeDefinitions", "SimpleType", "Enumeration"], "Item") => self.item(element),
            ([_, "VendorAnnotations"], "Tool") => {
                self.own_annotations = element.text("name") == Some(ANNOTATIONS);
                Ok(())
            }
            ([_, "VendorAnnotations", "Tool"], "Meanings") if self.own_annotations => {
                self.meanings.get_or_insert_default();
                Ok(())
            }
            ([_, "VendorAnnotations", "Tool", "Meanings"], "Variable") if self.own_annotations => {
                let meaning = Meaning {
                    role: element.text("role").and_then(word),
                    purpose: element.text("purpose").and_then(word).unwrap_or_default(),
                };
                let name = element.required("name")?.to_owned();
                self.meanings.get_or_insert_default().insert(name, meaning);
                Ok(())
            }
            ([_, "ModelVariables"], "ScalarVariable") => self.variable(element),
            ([_, "ModelVariables", "ScalarVariable"], name) => match Base::of(name) {
                Some(base) => self.variable_type(element, base),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }

    fn root(&mut self, element: &Element) -> Result<()> {
        // Before all else: other versions have other attributes.
        let version = element.required("fmiVersion")?;
        if version != "2.0" && !version.starts_with("2.0.") {
            return Err(element.wrong(&format!(
                "the attribute fmiVersion is {version:?}; only FMUs of FMI \"2.0\" can be imported"
            )));
        }
        self.root = Some(Root {
            version: version.into(),
            name: element.required("modelName")?.into(),
            guid: element.required("guid")?.into(),
            description: element.text("description").unwrap_or_default().into(),
            tool: element.text("generationTool").map(Into::into),
        });
        Ok(())
    }

    fn co_simulation(&mut self, element: &Element) -> Result<()> {
        if self.identifier.is_some() {
            return Err(element.wrong("there is a second <CoSimulation>; one is allowed"));
        }
        let identifier = element.required("modelIdentifier")?;
        if !is_c_identifier(identifier) {
            return Err(element.wrong(&format!(
                "the attribute modelIdentifier is {identifier:?}; it names the binary and has to be a C \
                 identifier (letters, digits and _, no digit first)"
            )));
        }
        self.identifier = Some(identifier.into());
        self.capabilities = Capabilities {
            needs_execution_tool: element.flag("needsExecutionTool")?,
            can_handle_variable_step: element.flag("canHandleVariableCommunicationStepSize")?,
            can_interpolate_inputs: element.flag("canInterpolateInputs")?,
            max_output_derivative_order: element.number("maxOutputDerivativeOrder")?.unwrap_or(0),
            // The standard's own spelling.
            can_run_asynchronously: element.flag("canRunAsynchronuously")?,
            can_be_instantiated_once: element.flag("canBeInstantiatedOnlyOncePerProcess")?,
            can_not_use_memory_functions: element.flag("canNotUseMemoryManagementFunctions")?,
            can_get_and_set_state: element.flag("canGetAndSetFMUstate")?,
            can_serialize_state: element.flag("canSerializeFMUstate")?,
            provides_directional_derivatives: element.flag("providesDirectionalDerivative")?,
        };
        Ok(())
    }

    fn item(&mut self, element: &Element) -> Result<()> {
        let item = Item {
            name: element.required("name")?.into(),
            value: element.required_number("value")?,
            description: element.text("description").unwrap_or_default().into(),
        };
        let Some(current) = self.traits.last_mut() else { return Ok(()) };
        let new_name = self.item_names.insert(item.name.clone());
        if !(self.item_values.insert(item.value) && new_name) {
            return Err(element.wrong(&format!(
                "the enumeration has the item {:?} or its value {} twice",
                item.name, item.value
            )));
        }
        current.size += size_of::<Item>() + item.name.len() + item.description.len();
        current.items.push(item);
        Ok(())
    }

    fn variable(&mut self, element: &Element) -> Result<()> {
        let name = element.required("name")?;
        if !self.names.insert(name.into()) {
            return Err(element.wrong(&format!("there are two variables with the name {name:?}")));
        }
        let causality = element.word(
            "causality",
            &[
                ("parameter", Causality::Parameter),
                ("calculatedParameter", Causality::CalculatedParameter),
                ("input", Causality::Input),
                ("output", Causality::Output),
                ("local", Causality::Local),
                ("independent", Causality::Independent),
            ],
        )?;
        let variability = element.word(
            "variability",
            &[
                ("constant", Variability::Constant),
                ("fixed", Variability::Fixed),
                ("tunable", Variability::Tunable),
                ("discrete", Variability::Discrete),
                ("continuous", Variability::Continuous),
            ],
        )?;
        let initial = element.word(
            "initial",
            &[("exact", Initial::Exact), ("approx", Initial::Approx), ("calculated", Initial::Calculated)],
        )?;
        self.rows.push(Row {
            place: element.place(),
            name: name.into(),
            reference: element.required_number("valueReference")?,
            description: element.text("description").unwrap_or_default().into(),
            causality: causality.unwrap_or(Causality::Local),
            variability,
            initial,
            declared: None,
            start: None,
            traits: Traits::default(),
        });
        Ok(())
    }

    fn variable_type(&mut self, element: &Element, base: Base) -> Result<()> {
        let Some(row) = self.rows.last_mut() else { return Ok(()) };
        if row.traits.base.is_some() {
            return Err(element.wrong(&format!("the variable {:?} has two types", row.name)));
        }
        row.traits = traits(element, base)?;
        row.declared = element.text("declaredType").map(Into::into);
        row.start = match base {
            Base::Real => element.real("start")?.map(Value::Real),
            Base::Integer | Base::Enumeration => element.number("start")?.map(Value::Integer),
            Base::Boolean => element.boolean("start")?.map(Value::Boolean),
            Base::String => element.text("start").map(|text| Value::Text(text.into())),
        };
        Ok(())
    }

    fn finish(self) -> Result<Description> {
        let whole = |what: &str| Error::fmu(format!("modelDescription.xml: {what}"));
        let root = self.root.ok_or_else(|| whole("there is no <fmiModelDescription>"))?;
        let model_identifier = self.identifier.ok_or_else(|| {
            whole(
                "there is no <CoSimulation>: an FMU for model exchange only has no solver and cannot be run",
            )
        })?;
        let mut left = MAX_INHERITED;
        let find = |name: &str| self.types.get(name).and_then(|index| self.traits.get(*index));
        let mut variables =
            self.rows.into_iter().map(|row| resolve(row, find, &mut left)).collect::<Result<Vec<_>>>()?;
        if let Some(meanings) = self.meanings {
            for variable in &mut variables {
                variable.meaning = Some(meanings.get(&variable.name).copied().unwrap_or_default());
            }
        }
        let start_time = self.experiment.start.unwrap_or(0.0);
        Ok(Description {
            fmi_version: root.version,
            guid: root.guid,
            generation_tool: root.tool,
            model_identifier,
            interface: Interface {
                name: root.name.clone(),
                description: root.description,
                communication_step: self.experiment.step_size.unwrap_or(COMMUNICATION_STEP),
                start_time,
                stop_time: self.experiment.stop.unwrap_or(start_time + EXPERIMENT_LENGTH),
                // the FMU may; this importer does not pass them on
                directional_derivatives: false,
                variables,
            },
            model_name: root.name,
            experiment: self.experiment,
            capabilities: self.capabilities,
        })
    }
}

fn traits(element: &Element, base: Base) -> Result<Traits> {
    let mut traits = Traits { base: Some(base), ..Traits::default() };
    match base {
        Base::Real => {
            traits.unit = element.text("unit").map(Into::into);
            traits.size = traits.unit.as_ref().map_or(0, String::len);
            traits.min = element.real("min")?;
            traits.max = element.real("max")?;
            traits.nominal = element.real("nominal")?;
        }
        Base::Integer | Base::Enumeration => {
            traits.min = element.number::<i32>("min")?.map(f64::from);
            traits.max = element.number::<i32>("max")?.map(f64::from);
        }
        Base::Boolean | Base::String => {}
    }
    Ok(traits)
}

/// Fills the gaps of a variable from its declared type and from FMI's defaults.
///
/// `left` is how much more may be taken over from types \[bytes\].
fn resolve<'a>(
    row: Row,
    find: impl Fn(&str) -> Option<&'a Traits>,
    left: &mut usize,
) -> Result<VariableInfo> {
    let wrong = |what: String| row.place.error(&format!("the variable {:?} {what}", row.name));
    let base = row.traits.base.ok_or_else(|| {
        wrong("has no type: one of <Real>, <Integer>, <Boolean>, <String>, <Enumeration> is needed".into())
    })?;
    let declared = match &row.declared {
        None if base == Base::Enumeration => {
            return Err(wrong("is an enumeration without the attribute declaredType".into()));
        }
        None => None,
        Some(name) => {
            let found = find(name).ok_or_else(|| {
                wrong(format!("has the declaredType {name:?}, which <TypeDefinitions> does not have"))
            })?;
            if found.base != Some(base) {
                return Err(wrong(format!(
                    "is {}, but its declaredType {name:?} is {}",
                    base.name(),
                    found.base.map_or("empty", Base::name)
                )));
            }
            *left = left.checked_sub(found.size).ok_or_else(|| {
                wrong(format!(
                    "is one too many with a long type: the variables take more than {MAX_INHERITED} bytes over from their types"
                ))
            })?;
            Some(found)
        }
    };
    let inherited = |own: Option<f64>, get: fn(&Traits) -> Option<f64>| own.or(declared.and_then(get));
    let mut min = inherited(row.traits.min, |t| t.min);
    let mut max = inherited(row.traits.max, |t| t.max);
    let kind = match base {
        Base::Real => Kind::Real,
        Base::Integer => Kind::Integer,
        Base::Boolean => Kind::Boolean,
        Base::String => Kind::Text,
        Base::Enumeration => {
            let mut items = declared.map(|t| t.items.clone()).unwrap_or_default();
            items.sort_by_key(|i| i.value);
            if (1..).zip(&items).all(|(n, item)| item.value == n) {
                Kind::Enumeration(items.into_iter().map(|i| (i.name, i.description)).collect())
            } else {
                // `Kind::Enumeration` counts 1, 2, ...; other values are kept as plain numbers.
                min = min.or(items.first().map(|i| f64::from(i.value)));
                max = max.or(items.last().map(|i| f64::from(i.value)));
                Kind::Integer
            }
        }
    };
    let variability = row.variability.unwrap_or(match (row.causality, base) {
        (Causality::Parameter | Causality::CalculatedParameter, _) => Variability::Fixed,
        (_, Base::Real) => Variability::Continuous,
        // The standard's default makes no sense here; all tools mean this.
        _ => Variability::Discrete,
    });
    let initial = match (row.causality, variability) {
        (Causality::Input | Causality::Independent, _) => None,
        (_, Variability::Constant) | (Causality::Parameter, _) => Some(Initial::Exact),
        _ => Some(row.initial.unwrap_or(Initial::Calculated)),
    };
    Ok(VariableInfo {
        unit: row.traits.unit.or_else(|| declared.and_then(|t| t.unit.clone())),
        nominal: inherited(row.traits.nominal, |t| t.nominal),
        name: row.name,
        reference: row.reference,
        description: row.description,
        kind,
        causality: row.causality,
        variability,
        initial,
        start: row.start,
        min,
        max,
        meaning: None,
    })
}

/// A role or purpose from its word; one of a later version is none.
fn word<T: serde::de::DeserializeOwned>(text: &str) -> Option<T> {
    serde_json::from_value(serde_json::Value::String(text.into())).ok()
}

fn is_c_identifier(text: &str) -> bool {
    !text.starts_with(|c: char| c.is_ascii_digit())
        && !text.is_empty()
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Hub &amp; rim" guid="{1}" generationTool="hand"
    description="test">
  <CoSimulation modelIdentifier="hub_1" canHandleVariableCommunicationStepSize="true"
      canInterpolateInputs="1" canGetAndSetFMUstate="true" maxOutputDerivativeOrder="2"/>
  <TypeDefinitions>
    <SimpleType name="Force"><Real unit="N" quantity="Force" min="-1e5" max="1e5" nominal="1000"/></SimpleType>
    <SimpleType name="Mode"><Enumeration>
      <Item name="on" value="2" description="it turns"/><Item name="off" value="1"/>
    </Enumeration></SimpleType>
    <SimpleType name="Sparse"><Enumeration><Item name="a" value="-3"/><Item name="b" value="7"/></Enumeration></SimpleType>
    <SimpleType name="Count"><Integer min="0" max="9"/></SimpleType>
  </TypeDefinitions>
  <DefaultExperiment startTime="1" stopTime="3.5" stepSize="0.01" tolerance="1e-6"/>
  <ModelVariables>
    <ScalarVariable name="F" valueReference="7" causality="input" initial="exact">
      <Real declaredType="Force" max="2e4" start="10"/>
      <Annotations><Tool name="x"><Real start="not read"/></Tool></Annotations>
    </ScalarVariable>
    <ScalarVariable name="x" valueReference="8"><Real unit="m"/></ScalarVariable>
    <ScalarVariable name="n" valueReference="1" causality="parameter" variability="tunable">
      <Integer declaredType="Count" start="3"/></ScalarVariable>
    <ScalarVariable name="b" valueReference="1" causality="parameter"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="s" valueReference="1" causality="local" variability="fixed" initial="exact">
      <String start="a&lt;b"/></ScalarVariable>
    <ScalarVariable name="m" valueReference="2" causality="output"><Enumeration declaredType="Mode"/></ScalarVariable>
    <ScalarVariable name="m2" valueReference="3" causality="output" variability="constant">
      <Enumeration declaredType="Sparse" start="7"/></ScalarVariable>
    <ScalarVariable name="time" valueReference="9" causality="independent"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"#;

    #[test]
    fn reads_all_types_and_defaults() {
        let d = Description::parse(GOOD.as_bytes()).unwrap();
        assert_eq!(
            (d.fmi_version.as_str(), d.model_name.as_str(), d.guid.as_str()),
            ("2.0", "Hub & rim", "{1}")
        );
        assert_eq!(d.generation_tool.as_deref(), Some("hand"));
        assert_eq!(d.model_identifier, "hub_1");
        let c = d.capabilities;
        assert!(c.can_handle_variable_step && c.can_interpolate_inputs && c.can_get_and_set_state);
        assert!(!c.can_serialize_state && !c.needs_execution_tool && !c.can_be_instantiated_once);
        assert_eq!(c.max_output_derivative_order, 2);
        let i = &d.interface;
        assert_eq!((i.start_time, i.stop_time, i.communication_step), (1.0, 3.5, 0.01));
        assert_eq!(d.experiment.tolerance, Some(1e-6));

        let v = |name: &str| &i.variables[i.find(name).unwrap()];
        let f = v("F");
        assert_eq!((f.reference, f.causality, f.variability), (7, Causality::Input, Variability::Continuous));
        assert_eq!(
            (f.unit.as_deref(), f.min, f.max, f.nominal),
            (Some("N"), Some(-1e5), Some(2e4), Some(1e3))
        );
        assert_eq!((f.initial, f.start.clone()), (None, Some(Value::Real(10.0))));
        let x = v("x");
        assert_eq!(
            (x.causality, x.initial, x.start.clone()),
            (Causality::Local, Some(Initial::Calculated), None)
        );
        let n = v("n");
        assert_eq!((n.kind.clone(), n.min, n.max), (Kind::Integer, Some(0.0), Some(9.0)));
        assert_eq!((n.variability, n.initial), (Variability::Tunable, Some(Initial::Exact)));
        let b = v("b");
        assert_eq!((b.kind.clone(), b.start.clone()), (Kind::Boolean, Some(Value::Boolean(true))));
        assert_eq!(b.variability, Variability::Fixed);
        assert_eq!(v("s").start, Some(Value::Text("a<b".into())));
        let items = vec![("off".into(), String::new()), ("on".into(), "it turns".into())];
        assert_eq!((&v("m").kind, v("m").variability), (&Kind::Enumeration(items), Variability::Discrete));
        let m2 = v("m2");
        assert_eq!((&m2.kind, m2.min, m2.max), (&Kind::Integer, Some(-3.0), Some(7.0)));
        assert_eq!(m2.initial, Some(Initial::Exact));
        assert_eq!(v("time").initial, None);
    }

    #[test]
    fn fills_in_a_default_experiment() {
        let text = GOOD.replace(r#"startTime="1" stopTime="3.5" stepSize="0.01""#, "");
        let i = Description::parse(format!("\u{feff}{text}").as_bytes()).unwrap().interface;
        assert_eq!((i.start_time, i.stop_time, i.communication_step), (0.0, 1.0, 1e-3));
    }

    #[test]
    fn says_what_is_wrong_and_where() {
        for (from, to, expected) in [
            (
                r#"fmiVersion="2.0""#,
                r#"fmiVersion="1.0""#,
                "line 2, column 1: <fmiModelDescription>: the attribute fmiVersion is \"1.0\"",
            ),
            (r#"fmiVersion="2.0""#, r#"fmiVersion="3.0""#, "only FMUs of FMI \"2.0\""),
            ("fmiModelDescription", "modelica", "the outermost element is <modelica>"),
            ("CoSimulation", "ModelExchange", "there is no <CoSimulation>"),
            (r#"guid="{1}""#, "", "the attribute guid is missing"),
            (
                r#"modelIdentifier="hub_1""#,
                r#"modelIdentifier="../hub""#,
                "line 4, column 3: <CoSimulation>: the attribute modelIdentifier is \"../hub\"",
            ),
            (r#"modelIdentifier="hub_1""#, r#"modelIdentifier="1hub""#, "C identifier"),
            (r#"modelIdentifier="hub_1""#, "", "modelIdentifier is missing"),
            (
                r#"canInterpolateInputs="1""#,
                r#"canInterpolateInputs="yes""#,
                "canInterpolateInputs is \"yes\"; true or false is needed",
            ),
            (
                r#"valueReference="8""#,
                r#"valueReference="-8""#,
                "line 20, column 5: <ScalarVariable>: the attribute valueReference is \"-8\"",
            ),
            (r#"valueReference="8""#, "", "valueReference is missing"),
            (r#"start="10""#, r#"start="ten""#, "start is \"ten\"; a finite number is needed"),
            (r#"start="10""#, r#"start="NaN""#, "finite"),
            (r#"start="3""#, r#"start="3.5""#, "start is \"3.5\"; a whole number"),
            (r#"start="true""#, r#"start="wahr""#, "true or false"),
            (
                r#"name="x""#,
                r#"name="F""#,
                "line 20, column 5: <ScalarVariable>: there are two variables with the name \"F\"",
            ),
            (r#"causality="independent""#, r#"causality="indep""#, "parameter, calculatedParameter, input"),
            (
                r#"declaredType="Force""#,
                r#"declaredType="Farce""#,
                "line 16, column 5: the variable \"F\" has the declaredType \"Farce\"",
            ),
            (
                r#"declaredType="Force""#,
                r#"declaredType="Count""#,
                "is Real, but its declaredType \"Count\" is Integer",
            ),
            (r#"<Enumeration declaredType="Mode"/>"#, "<Enumeration/>", "without the attribute declaredType"),
            (r#"<Real unit="m"/>"#, "", "the variable \"x\" has no type"),
            (r#"<Real unit="m"/>"#, r#"<Real unit="m"/><Integer/>"#, "two types"),
            (r#"<Real unit="m"/>"#, r#"<Real unit="m">"#, "line 20"),
            (r#"name="off" value="1""#, r#"name="off" value="2""#, "twice"),
            (r#"name="Sparse""#, r#"name="Mode""#, "defined twice"),
            (r#"stepSize="0.01""#, r#"stepSize="0""#, "positive"),
            ("</fmiModelDescription>\n", "", "is not closed"),
            ("&amp;", "&amp", "line 2"),
            ("&amp;", "&boom;", "boom"),
            (r#"guid="{1}""#, r#"guid="{1}" guid="{2}""#, "line 2"),
            (
                "\n<fmiModel",
                "\n<!DOCTYPE x [<!ENTITY a \"aa\">]>\n<fmiModel",
                "line 2, column 1: there is a DOCTYPE",
            ),
            ("</fmiModelDescription>\n", "</fmiModelDescription><fmiModelDescription/>", "after the end"),
            ("</fmiModelDescription>\n", "</fmiModelDescription>text", "after the end"),
        ] {
            assert!(GOOD.contains(from), "{from}");
            let text = GOOD.replace(from, to);
            let error = Description::parse(text.as_bytes()).expect_err(to);
            let message = error.to_string();
            assert!(
                message.contains(expected),
                "{from} -> {to}\n  expected: {expected}\n  message:  {message}"
            );
            assert!(message.starts_with("modelDescription.xml"), "{message}");
            assert_eq!(error.kind(), crate::ErrorKind::Fmu);
        }
        for (bytes, expected) in
            [(&b""[..], "there is no <fmiModelDescription>"), (b"junk", "outside"), (b"<a\xff/>", "UTF-8")]
        {
            let message = Description::parse(bytes).unwrap_err().to_string();
            assert!(message.contains(expected), "{message}");
        }
        let deep = "<a>".repeat(100_000);
        let deep = GOOD.replace("<ModelStructure/>", &deep);
        assert!(Description::parse(deep.as_bytes()).unwrap_err().to_string().contains("deep"));
    }

    #[test]
    fn survives_any_cut() {
        let end = GOOD.trim_end().len();
        for length in 0..end {
            let message = Description::parse(&GOOD.as_bytes()[..length]).unwrap_err().to_string();
            assert!(message.starts_with("modelDescription.xml"), "{message}");
        }
    }
}
