use super::*;
use crate::answer::{Effect, Fault, ReferenceRun};
use crate::catalogue::alike;

fn answer(kind: &str, ids: &[&str]) -> Answer {
    let effect = |id: &&str| Effect {
        id: (*id).into(),
        accept: alike(id),
        depends_on: vec!["speed".into()],
        over_noise: 4.0,
        ..Effect::default()
    };
    Answer {
        case: "case-001".into(),
        kind: kind.into(),
        detail: ids.join(" + "),
        effects: ids.iter().map(effect).collect(),
        ..Answer::default()
    }
}

fn judged(answer: Answer, diagnosis: &str) -> Judgement {
    let diagnosis: Diagnosis = serde_json::from_str(diagnosis).unwrap();
    judge(answer, &Reference::default(), Some(&diagnosis), &Timing::default())
}

#[test]
fn a_name_is_judged_by_id_by_family_and_among_three() {
    let truth = || answer("clear", &["relaxation-length"]);
    let j = judged(
        truth(),
        r#"{"verdict":"effect","findings":[{"effect":"carcass-compliance","confidence":0.9}]}"#,
    );
    assert!(j.id_first && j.family_first && j.family_three && !j.wrong_name);
    assert_eq!(j.confidence, Some(0.9));
    let j = judged(truth(), r#"{"verdict":"effect","findings":[{"effect":"camber-thrust"}]}"#);
    assert!(!j.id_first && j.family_first && j.wrong_name);
    let alternatives = r#"{"verdict":"family","findings":[{"effect":"sensor-lag","confidence":0.6,"alternatives":[
        {"effect":"cross-talk","confidence":0.1},{"effect":"relaxation-length","confidence":0.3}]}]}"#;
    let j = judged(truth(), alternatives);
    assert!(!j.family_first && j.family_three && !j.wrong_name);
    // named as one that excludes the rivals, it is wrong
    let j = judged(truth(), &alternatives.replace("\"family\",\"f", "\"effect\",\"f"));
    assert!(j.wrong_name && j.family_three);
    let j = judged(
        truth(),
        r#"{"verdict":"unknown","findings":[{"effect":"relaxation-length","depends_on":["Speed"]}]}"#,
    );
    assert!(!j.named && !j.family_first && j.dependence == Some(true));
}

#[test]
fn every_effect_of_a_mix_needs_a_finding_of_its_own() {
    let truth = || answer("mix", &["relaxation-length", "sensor-delay"]);
    let both = r#"{"verdict":"effect","findings":[{"effect":"sensor-lag"},{"effect":"carcass-compliance"}]}"#;
    assert!(judged(truth(), both).all_found);
    let twice =
        r#"{"verdict":"effect","findings":[{"effect":"relaxation-length"},{"effect":"carcass-compliance"}]}"#;
    assert!(!judged(truth(), twice).all_found);
}

#[test]
fn errors_are_compared_over_the_checking_runs() {
    let run = |name: &str, samples, square| ReferenceRun {
        name: name.into(),
        samples,
        channels: vec![("force".into(), square), ("other".into(), 1.0)],
    };
    let reference = Reference {
        runs: vec![run("run-01.csv", 100, 9.0), run("run-02.csv", 100, 1.0), run("run-03.csv", 300, 5.0)],
    };
    let diagnosis: Diagnosis = serde_json::from_str(
        r#"{"verdict":"nothing","check":[{"channel":"force","after":4.0},{"channel":"other","after":1.0},{"channel":"absent","after":9.0}],
            "runs":[{"name":"run-01.csv","use":"fit"},{"name":"run-02","use":"check"},{"name":"run-03.csv","use":"check"}]}"#,
    )
    .unwrap();
    let j = judge(answer("null", &[]), &reference, Some(&diagnosis), &Timing::default());
    // noise: (100 * 1 + 300 * 5) / 400 = 4; ratios squared 16/4 and 1
    assert!((j.error_ratio.unwrap() - 2.5_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn the_table_counts_a_made_up_study() {
    let mut all = Vec::new();
    for k in 0..10 {
        let id = if k == 0 { "sensor-bias" } else { "camber-thrust" };
        all.push(judged(
            answer("clear", &["camber-thrust"]),
            &format!(r#"{{"verdict":"effect","findings":[{{"effect":"{id}","confidence":0.9}}]}}"#),
        ));
    }
    all.push(judged(answer("null", &[]), r#"{"verdict":"nothing"}"#));
    all.push(judged(answer("fault", &[]), r#"{"verdict":"recording","findings":[{"effect":"stuck"}]}"#));
    all.push(judged(
        answer("outside", &["outside-snap"]),
        r#"{"verdict":"effect","findings":[{"effect":"play","confidence":0.9}]}"#,
    ));
    all.push(judge(
        answer("null", &[]),
        &Reference::default(),
        None,
        &Timing { seconds: Some(60.0), failure: Some("took too long".into()) },
    ));
    for seconds in [300.0, 400.0] {
        let truth = Answer { model: "ring-brush-flat-track".into(), ..answer("outside", &["outside-snap"]) };
        let unknown = serde_json::from_str(r#"{"verdict":"unknown"}"#).unwrap();
        let timing = Timing { seconds: Some(seconds), failure: None };
        all.push(judge(truth, &Reference::default(), Some(&unknown), &timing));
    }
    let text = report(&all);
    let has = |line: &str| assert!(text.contains(line), "{line}\n{text}");
    has("| clear effects: the right family named first | 95 % | 90 % | 9 of 10 | 60 to 98 % | no |");
    has("| clear effects: among the first three | 98 % | 90 % | 9 of 10 | 60 to 98 % | no |");
    has(
        "| nothing missing, or parameters only: something named | at most 2 % | 0 % | 0 of 2 | 0 to 66 % | yes |",
    );
    has("| not in the catalogue: says so | 93 % | 67 % | 2 of 3 |");
    has("| diagnosis of a cheap base model within 20 s | 100 % | 0 % | 0 of 1 |");
    has("| diagnosis of the flat track within 6 minutes | 100 % | 50 % | 1 of 2 |");
    has("Longest diagnosis of a cheap base model: 60.0 s, of the flat track: 400.0 s.");
    has("| recording faults: reported as such | 95 % | 100 % | 1 of 1 |");
    has("| stated confidence of 0.85 to 0.95: right | 85 to 95 % | 82 % | 9 of 11 |");
    has("| mixes: both found | 85 % | - | 0 of 0 | - | no case |");
    has("| no diagnosis came |  | 6 % | 1 of 16 |");
    has("| case-001 | null |  |  | took too long | - | 60.0 |");
    has("| camber-thrust | 9 of 10 | 9 of 10 | 0 of 0 | 0 of 0 | 0 of 0 |");
}

#[test]
fn folders_are_read_and_what_is_missing_counts_as_failed() {
    let folder = tempfile::tempdir().unwrap();
    let (answers, results) = (folder.path().join("answers"), folder.path().join("results"));
    crate::files::case(1, 0).unwrap().write_answer(&answers).unwrap();
    let all = judge_all(&answers, &results).unwrap();
    assert_eq!(all.len(), 1);
    assert!(all[0].failed);
    crate::files::write(&results.join("case-001/diagnosis.json"), r#"{"verdict":"unknown","more":[1]}"#)
        .unwrap();
    crate::files::write(&results.join("case-001/timing.json"), r#"{"seconds":3.5,"version":"x"}"#).unwrap();
    let all = judge_all(&answers, &results).unwrap();
    assert_eq!((all[0].failed, all[0].seconds, all[0].verdict.as_str()), (false, Some(3.5), "unknown"));
}

#[test]
fn a_fault_is_placed_where_it_is_and_nowhere_else() {
    let fault = |name: &str, channels: &[&str], runs: &[&str]| Fault {
        name: name.into(),
        channels: channels.iter().map(|s| (*s).to_owned()).collect(),
        runs: runs.iter().map(|s| (*s).to_owned()).collect(),
    };
    let placed = |fault: &Fault, said: &str| {
        let truth = Answer { fault: Some(fault.clone()), ..answer("fault", &[]) };
        judged(truth, &format!(r#"{{"verdict":"recording","faults":[{said}]}}"#)).fault_placed
    };
    let said = |channel: &str, runs: &str| {
        let channel = if channel.is_empty() { "null".into() } else { format!("\"{channel}\"") };
        format!(r#"{{"kind":"offset","channel":{channel},"runs":{runs}}}"#)
    };
    let offset = fault("offset", &["force"], &["run-02.csv", "run-05.csv"]);
    assert!(placed(&offset, &said("force", r#"["run-05.csv","run-02.csv"]"#)));
    // split in two, and by stem
    let split = said("force", r#"["run-02"]"#) + "," + &said("force", r#"["run-05"]"#);
    assert!(placed(&offset, &split));
    assert!(!placed(&offset, &said("force", r#"["run-05.csv"]"#)));
    assert!(!placed(&offset, &said("force", r#"["run-02.csv","run-05.csv","run-06.csv"]"#)));
    assert!(!placed(&offset, &said("moment", r#"["run-05.csv","run-02.csv"]"#)));
    assert!(!placed(&offset, &(split + "," + &said("moment", r#"["run-02"]"#))));
    assert!(!placed(&offset, ""));
    // in all runs, of two channels, of all channels, copies
    assert!(placed(&fault("sign", &["force"], &[]), &said("force", r#"["run-01"]"#)));
    let swapped = fault("swapped", &["force", "moment"], &[]);
    assert!(placed(&swapped, &said("moment", "[]")) && placed(&swapped, &said("force, moment", "[]")));
    assert!(!placed(&swapped, &said("force, speed", "[]")));
    let jump = fault("time-jump", &[], &["run-03.csv"]);
    assert!(placed(&jump, &said("", r#"["run-03.csv"]"#)) && !placed(&jump, &said("", r#"["run-04.csv"]"#)));
    let copies = fault("duplicated", &[], &["run-03.csv", "run-04.csv"]);
    assert!(
        placed(&copies, &said("", r#"["run-04.csv"]"#)) && !placed(&copies, &said("", r#"["run-05.csv"]"#))
    );
}

#[test]
fn intervals_of_an_effect_are_held_against_its_own_parameters() {
    let truth = || {
        let mut answer = answer("clear", &["coulomb-friction"]);
        answer.effects[0].amounts = vec![("force".into(), 2.0), ("velocity".into(), 0.1)];
        answer
    };
    // a 95 % interval of 1 +- 1.1 holds 2, one of 90 % does not; of a parameter without an end nothing is known
    let found = |name: &str| {
        format!(
            r#"{{"verdict":"effect","findings":[{{"effect":"{name}","parameters":[
            {{"name":"force","value":1.0,"low":-0.1,"high":2.1}},{{"name":"velocity","value":0.1,"low":0.05}}]}}]}}"#
        )
    };
    assert_eq!(judged(truth(), &found("coulomb-friction")).amounts_held, [false]);
    let wider = found("coulomb-friction").replace("2.1", "2.5");
    assert_eq!(judged(truth(), &wider).amounts_held, [true]);
    let whole = wider.replace("\"low\":0.05", "\"low\":0.11,\"high\":0.12");
    assert_eq!(judged(truth(), &whole).amounts_held, [true, false]);
    // a name that is accepted, but another one, has other parameters
    assert!(judged(truth(), &found("stribeck-friction")).amounts_held.is_empty());
}
