//! The rules that are checked: where they are written and what to do about a finding.

/// A rule of the standard, or of good sense where the standard is silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rule {
    /// Short name, such as "X10".
    pub name: &'static str,
    /// What has to be true.
    pub title: &'static str,
    /// Where that is written.
    pub citation: &'static str,
    /// What to do when it is not.
    pub help: &'static str,
}

/// All rules, in the order in which findings are easiest to repair.
pub const RULES: &[Rule] = &[
    Rule {
        name: "Z1",
        title: "the archive uses nothing but plain zip: store or deflate, no encryption, links, parts or tricks",
        citation: "FMI 2.0.5, 2.3",
        help: "pack the folder anew with deflate, such as `zip -r ../model.fmu *` inside of it",
    },
    Rule {
        name: "Z2",
        title: "binaries are in folders with the names of platforms",
        citation: "FMI 2.0.5, 2.3",
        help: "name the folder win32, win64, linux32, linux64, darwin32 or darwin64, or like aarch64-linux",
    },
    Rule {
        name: "Z3",
        title: "binaries load without anything that the FMU does not bring",
        citation: "FMI 2.0.5, 2.3",
        help: "link statically, or put the libraries beside the binary with the RPATH $ORIGIN",
    },
    Rule {
        name: "Z4",
        title: "sources that are listed are there, and extra/ has folders with reversed domain names",
        citation: "FMI 2.0.5, 2.3",
        help: "put the files into sources/, and own data into folders such as extra/org.example.tool",
    },
    Rule {
        name: "XML",
        title: "modelDescription.xml is well-formed XML",
        citation: "Extensible Markup Language (XML) 1.0; FMI 2.0.5, 2.2",
        help: "write the file with an XML library, which escapes <, & and quotes and closes elements",
    },
    Rule {
        name: "XSD",
        title: "elements and attributes are those of the schema, in its order and with its types",
        citation: "FMI 2.0.5, 2.2, fmi2ModelDescription.xsd",
        help: "compare with the schema; tools' own data belongs into VendorAnnotations or Annotations",
    },
    Rule {
        name: "CS",
        title: "the FMU has a part for co-simulation",
        citation: "FMI 2.0.5, 4.3.1",
        help: "export the model for co-simulation; FMUs for model exchange are not run here",
    },
    Rule {
        name: "X1",
        title: "fmiVersion is 2.0 and the file is UTF-8",
        citation: "FMI 2.0.5, 2.2 and 2.2.1",
        help: "write fmiVersion=\"2.0\" for every 2.0.x, and encoding=\"UTF-8\"",
    },
    Rule {
        name: "X2",
        title: "modelIdentifier is a C identifier and the name of the binary",
        citation: "FMI 2.0.5, 2.1.1 and 4.3.1",
        help: "use letters, digits and _ without a digit in front, and name the binary like it",
    },
    Rule {
        name: "X3",
        title: "guid is given, and the binary knows it",
        citation: "FMI 2.0.5, 2.1.5 and 2.2.1",
        help: "make the GUID from the content of the description and compile it into the binary",
    },
    Rule {
        name: "X4",
        title: "only Real variables are continuous, which is also the default",
        citation: "FMI 2.0.5, 2.2.7",
        help: "write variability=\"discrete\" (or what fits) for variables that are not Real",
    },
    Rule {
        name: "X5",
        title: "causality and variability fit together",
        citation: "FMI 2.0.5, 2.2.7",
        help: "parameters: fixed or tunable; inputs: discrete or continuous; outputs also constant",
    },
    Rule {
        name: "X6",
        title: "initial fits causality and variability",
        citation: "FMI 2.0.5, 2.2.7",
        help: "inputs and the independent variable have no initial; parameters and constants are exact",
    },
    Rule {
        name: "X7",
        title: "start values are there where they are needed and only there, and are those of the binary",
        citation: "FMI 2.0.5, 2.2.7",
        help: "give inputs, parameters, constants, exact and approx variables a start; no others",
    },
    Rule {
        name: "X8",
        title: "there is at most one independent variable: a continuous Real without start",
        citation: "FMI 2.0.5, 2.2.7",
        help: "keep one variable with causality=\"independent\", or none",
    },
    Rule {
        name: "X9",
        title: "Outputs and Derivatives list exactly the outputs and derivatives",
        citation: "FMI 2.0.5, 2.2.8",
        help: "list every output once by its position in ModelVariables, counted from 1",
    },
    Rule {
        name: "X10",
        title: "InitialUnknowns lists exactly the unknowns of the initialization, sorted",
        citation: "FMI 2.0.5, 2.2.8",
        help: "list outputs and states that are approx or calculated, and calculatedParameters, by index",
    },
    Rule {
        name: "X11",
        title: "dependencies are sorted, exist, and have as many kinds",
        citation: "FMI 2.0.5, 2.2.8",
        help: "write both lists in the same order with rising indices; leave both out for \"on everything\"",
    },
    Rule {
        name: "X12",
        title: "units are declared, and names are unique",
        citation: "FMI 2.0.5, 2.2.2, 2.2.3, 2.2.4 and 2.2.7",
        help: "declare every unit in UnitDefinitions, and rename what occurs twice",
    },
    Rule {
        name: "X13",
        title: "the items of an enumeration have their own names and values",
        citation: "FMI 2.0.5, 2.2.3",
        help: "give every Item another name and another value, and use only these as start values",
    },
    Rule {
        name: "X14",
        title: "variables with the same value reference fit together",
        citation: "FMI 2.0.5, 2.2.7",
        help: "give variables that are set from outside value references of their own",
    },
    Rule {
        name: "X15",
        title: "attributes for model exchange are absent",
        citation: "FMI 2.0.5, 2.2.7",
        help: "remove reinit and canHandleMultipleSetPerTimeInstant",
    },
    Rule {
        name: "X16",
        title: "structured names follow the grammar, and elements of arrays stand together",
        citation: "FMI 2.0.5, 2.2.9",
        help: "write names like a.b[1,2].c or der(a.b), or variableNamingConvention=\"flat\"",
    },
    Rule {
        name: "X17",
        title: "declared types exist and fit, and limits do not contradict each other",
        citation: "FMI 2.0.5, 2.2.3 and 2.2.7",
        help: "correct declaredType, min, max or start; a variable inherits the limits of its type",
    },
    Rule {
        name: "X18",
        title: "the default experiment is possible",
        citation: "FMI 2.0.5, 2.2.5",
        help: "stopTime has to be after startTime (default 0); stepSize and tolerance have to be positive",
    },
    Rule {
        name: "M7",
        title: "only states that can be saved can be serialised",
        citation: "FMI 2.0.5, 4.3.1",
        help: "set canGetAndSetFMUstate=\"true\" as well, or canSerializeFMUstate=\"false\"",
    },
    Rule {
        name: "L1",
        title: "categories of messages are declared and have unique names",
        citation: "FMI 2.0.5, 2.1.5 and 2.2.4",
        help: "declare each category once in LogCategories; log with NULL if there are none",
    },
    Rule {
        name: "L2",
        title: "messages come only in categories that are switched on",
        citation: "FMI 2.0.5, 2.1.5",
        help: "ask for the category's switch before calling the logger",
    },
    Rule {
        name: "L3",
        title: "messages are formats for printf in which # is an escape as well",
        citation: "FMI 2.0.5, 2.1.5",
        help: "write %% and ## where the signs themselves are meant, and end without a line break",
    },
    Rule {
        name: "L4",
        title: "the logger gets back the master's environment and the instance's name",
        citation: "FMI 2.0.5, 2.1.5",
        help: "copy both in fmi2Instantiate and pass them on unchanged",
    },
    Rule {
        name: "L5",
        title: "a status that is not OK comes with a message",
        citation: "FMI 2.0.5, 2.1.3",
        help: "call the logger before returning fmi2Warning, fmi2Discard, fmi2Error or fmi2Fatal",
    },
    Rule {
        name: "M8",
        title: "the binary exports all functions of co-simulation, also those that it does not support",
        citation: "FMI 2.0.5, 2.1.1 and 2.3",
        help: "export the missing functions; those without support return fmi2Error or fmi2Discard",
    },
    Rule {
        name: "V1",
        title: "fmi2GetVersion returns 2.0 and fmi2GetTypesPlatform returns default",
        citation: "FMI 2.0.5, 2.1.2 and 2.1.4",
        help: "return the texts of the standard's header files",
    },
    Rule {
        name: "S1",
        title: "texts from the master are copied",
        citation: "FMI 2.0.5, 2.1.5 and 2.1.7",
        help: "copy the text before returning: the master may free it at once",
    },
    Rule {
        name: "S3",
        title: "fmi2Instantiate refuses a wrong GUID and a blank name, with a message",
        citation: "FMI 2.0.5, 2.1.5",
        help: "compare the GUID with the compiled one, call the logger, and return NULL",
    },
    Rule {
        name: "S4",
        title: "the struct of callback functions is copied",
        citation: "FMI 2.0.5, 2.1.5",
        help: "copy the members of fmi2CallbackFunctions in fmi2Instantiate, not the pointer",
    },
    Rule {
        name: "S5",
        title: "the master's functions for memory are used in pairs, or not at all where the FMU says so",
        citation: "FMI 2.0.5, 2.1.5",
        help: "give back with freeMemory what allocateMemory returned and nothing else, or call neither of them",
    },
    Rule {
        name: "S6",
        title: "freeing nothing does nothing, and a NULL instance is survived",
        citation: "FMI 2.0.5, 2.1.5 and 2.1.8",
        help: "return at once for a NULL pointer: with no effect when freeing, else with fmi2Error",
    },
    Rule {
        name: "S7",
        title: "the resource location is read as a URI of the scheme file, with or without authority",
        citation: "FMI 2.0.5, 2.1.5; RFC 3986",
        help: "accept file:///path, file:/path and file://localhost/path, and decode %20 and its like",
    },
    Rule {
        name: "S8",
        title: "an FMU leaves the process as it was and instances leave each other alone",
        citation: "FMI 2.0.5, 2.1.1",
        help: "use no global variables, no stdout or stderr, and restore the floating-point control word",
    },
    Rule {
        name: "S9",
        title: "value references that do not exist, and setting constants, are errors",
        citation: "FMI 2.0.5, 2.1.7",
        help: "look up every value reference before using it, and return fmi2Error",
    },
    Rule {
        name: "S10",
        title: "memory does not grow from instance to instance",
        citation: "FMI 2.0.5, 2.1.5",
        help: "free in fmi2FreeInstance all that the instance allocated",
    },
    Rule {
        name: "S11",
        title: "the library goes away when it is closed",
        citation: "none: masters that replace or delete the file depend on it",
        help: "use no threads that outlive instances and no thread-local data with destructors",
    },
    Rule {
        name: "S12",
        title: "the same calls give the same results",
        citation: "none: without it no result can be reproduced",
        help: "initialise all memory, and take neither the clock nor global variables into the results",
    },
    Rule {
        name: "M0",
        title: "the FMU runs its default experiment",
        citation: "FMI 2.0.5, 4.2.2 and 4.2.4",
        help: "run the FMU with its start values; read its messages",
    },
    Rule {
        name: "M1",
        title: "initialization goes in order: setup, enter, exit",
        citation: "FMI 2.0.5, 2.1.6 and 4.2.4",
        help: "keep the state of the instance and return fmi2Error for calls that it forbids",
    },
    Rule {
        name: "M2",
        title: "nothing is read before initialization",
        citation: "FMI 2.0.5, 4.2.4",
        help: "return fmi2Error from the fmi2Get functions before fmi2EnterInitializationMode",
    },
    Rule {
        name: "M3",
        title: "only inputs and tunable parameters are set between steps",
        citation: "FMI 2.0.5, 4.2.4",
        help: "return fmi2Error from the fmi2Set functions for fixed parameters, outputs and local variables",
    },
    Rule {
        name: "M5",
        title: "fmi2Terminate ends a run and fmi2Reset makes the instance as new",
        citation: "FMI 2.0.5, 2.1.6 and 4.2.4",
        help: "reset everything that fmi2Instantiate sets, start values included",
    },
    Rule {
        name: "M6",
        title: "a restored state continues as the saved one",
        citation: "FMI 2.0.5, 2.1.8",
        help: "save all that a step depends on: inputs, parameters, buffers, random numbers, time",
    },
    Rule {
        name: "D1",
        title: "steps have a positive length, start where the last one ended, and end where they should",
        citation: "FMI 2.0.5, 4.2.2",
        help: "return fmi2Error for a length that is not a positive number or another start, without a step",
    },
    Rule {
        name: "D2",
        title: "steps beyond the stop time are errors",
        citation: "FMI 2.0.5, 2.1.6",
        help: "return fmi2Error from fmi2DoStep beyond the stop time that fmi2SetupExperiment defined",
    },
    Rule {
        name: "D5",
        title: "noSetFMUStatePriorToCurrentPoint says what may be forgotten and changes no result",
        citation: "FMI 2.0.5, 4.2.2",
        help: "accept fmi2True and fmi2False; with fmi2True only buffers for going back may be dropped",
    },
    Rule {
        name: "D6",
        title: "statuses are those of the standard, and fmi2Pending only comes from asynchronous steps",
        citation: "FMI 2.0.5, 2.1.3",
        help: "return fmi2Pending only if canRunAsynchronuously is true and the master gave stepFinished",
    },
    Rule {
        name: "D7",
        title: "derivatives of inputs have orders from 1, and are accepted where the FMU interpolates",
        citation: "FMI 2.0.5, 4.2.1",
        help: "accept order 1 if canInterpolateInputs is true; return fmi2Error for order 0",
    },
    Rule {
        name: "D8",
        title: "numbers that are not finite do not pass unnoticed",
        citation: "FMI 2.0.5, 2.2 for the description; none for inputs",
        help: "return fmi2Discard or fmi2Error with a message for values that are not finite",
    },
    Rule {
        name: "D9",
        title: "directional derivatives are the derivatives of the outputs",
        citation: "FMI 2.0.5, 2.1.9",
        help: "compare fmi2GetDirectionalDerivative with differences of the outputs",
    },
    Rule {
        name: "D10",
        title: "the result depends little on how time is cut into steps",
        citation: "FMI 2.0.5, 4.2.2 and 4.3.1",
        help: "step internally with an own step length, or set canHandleVariableCommunicationStepSize=\"false\"",
    },
];

/// The rule called `name`. A name that is not in the table gives the last rule; a test keeps that from
/// happening.
pub(super) fn rule(name: &str) -> &'static Rule {
    debug_assert!(RULES.iter().any(|r| r.name == name), "no rule {name}");
    RULES.iter().find(|r| r.name == name).unwrap_or(&RULES[RULES.len() - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        for (i, rule) in RULES.iter().enumerate() {
            assert!(RULES[..i].iter().all(|r| r.name != rule.name), "{}", rule.name);
        }
    }
}
