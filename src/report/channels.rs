//! Which channels of a run share a picture, and under which heading: for models whose channels nobody knows, and for systems.

use crate::recording::Channel;

/// More lines than this in one plot cannot be told apart.
pub const MAX_LINES: usize = 6;
/// Channels share a plot if the largest values of any two differ by less than this factor.
const MAX_RATIO: f64 = 30.0;

/// Channels that share a plot.
#[derive(Debug, Default)]
pub struct Picture<'a> {
    /// What its axis says.
    pub quantity: String,
    pub unit: &'a str,
    /// Names of channels, and what a line is called.
    pub lines: Vec<(&'a str, String)>,
    /// Smallest and largest of the channels' largest magnitudes; none if all are zero.
    sizes: Option<(f64, f64)>,
}

/// Pictures of components that have the same variables.
#[derive(Debug)]
pub struct Chapter<'a> {
    /// Names of the components; empty where channels do not say whose they are.
    pub components: Vec<&'a str>,
    pub pictures: Vec<Picture<'a>>,
}

/// Pictures of channels in their order. Channels `component.variable` have a chapter for each component, or for all that have the same variables; what has the
/// same name in several places, such as `front_left.wheel_speed` and `front_right.wheel_speed` or `pressure_1` and `pressure_2`, has a picture of its own. All others are together by unit and size.
pub fn chapters<'a>(channels: &[&'a Channel]) -> Vec<Chapter<'a>> {
    // components, the variables of each, and whose channels they are
    let mut parts: Vec<(Vec<&str>, Vec<&str>, Vec<&Channel>)> = Vec::new();
    for &channel in channels {
        let (component, variable) = channel.name.split_once('.').unwrap_or(("", &channel.name));
        match parts.iter_mut().find(|(components, ..)| components[..] == [component]) {
            Some((_, variables, own)) => {
                variables.push(variable);
                own.push(channel);
            }
            None => parts.push((vec![component], vec![variable], vec![channel])),
        }
    }
    let mut chapters: Vec<(Vec<&str>, Vec<&str>, Vec<&Channel>)> = Vec::new();
    for (components, variables, own) in parts {
        match chapters.iter_mut().find(|(_, others, _)| *others == variables) {
            Some((names, _, all)) => {
                names.extend(components);
                all.extend(own);
            }
            None => chapters.push((components, variables, own)),
        }
    }
    let chapter = |(components, _, own): (Vec<&'a str>, _, Vec<&'a Channel>)| Chapter {
        pictures: pictures(&components, &own),
        components: components.into_iter().filter(|name| !name.is_empty()).collect(),
    };
    chapters.into_iter().map(chapter).collect()
}

/// What a channel is of, whatever place it is at: the last part of its name, without a number.
fn quantity(name: &str) -> &str {
    let last = name.rsplit('.').next().unwrap_or(name);
    match last.rsplit_once('_') {
        Some((stem, number)) if !number.is_empty() && number.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => last,
    }
}

/// What tells a channel from the others of its quantity.
fn place(name: &str, only: Option<&str>) -> String {
    let name = only.and_then(|component| name.strip_prefix(component)?.strip_prefix('.')).unwrap_or(name);
    let rest = name.strip_suffix(quantity(name)).and_then(|rest| rest.strip_suffix('.'));
    rest.unwrap_or(name).to_owned()
}

fn pictures<'a>(components: &[&str], channels: &[&'a Channel]) -> Vec<Picture<'a>> {
    let only = if let [one] = components { Some(*one) } else { None };
    let is_beside = |a: &Channel, b: &Channel| quantity(&a.name) == quantity(&b.name) && a.unit == b.unit;
    let mut pictures: Vec<(bool, Picture)> = Vec::new();
    for &channel in channels {
        // names that say no place are no family
        let said = channel.name.contains('.');
        let has_others = said && channels.iter().filter(|other| is_beside(channel, other)).count() > 1;
        let fits = |(of_one, picture): &(bool, Picture)| {
            *of_one == has_others
                && picture.takes(channel)
                && (!has_others || quantity(picture.lines[0].0) == quantity(&channel.name))
        };
        let label = if has_others { place(&channel.name, only) } else { channel.name.clone() };
        match pictures.iter_mut().find(|picture| fits(picture)) {
            Some((_, picture)) => picture.add(channel, label),
            None => {
                let mut picture = Picture { unit: &channel.unit, ..Picture::default() };
                picture.add(channel, label);
                pictures.push((has_others, picture));
            }
        }
    }
    for (of_one, picture) in &mut pictures {
        picture.quantity = match &picture.lines[..] {
            _ if *of_one => quantity(picture.lines[0].0).replace('_', " "),
            [(name, _)] => (*name).to_owned(),
            _ => "value".to_owned(),
        };
    }
    pictures.into_iter().map(|(_, picture)| picture).collect()
}

impl<'a> Picture<'a> {
    /// Its sizes with those of one more channel.
    fn with(&self, channel: &Channel) -> Option<(f64, f64)> {
        let size = channel.values.iter().filter(|v| v.is_finite()).fold(0.0_f64, |m, v| m.max(v.abs()));
        match self.sizes {
            sizes if size == 0.0 => sizes,
            None => Some((size, size)),
            Some((low, high)) => Some((low.min(size), high.max(size))),
        }
    }

    fn takes(&self, channel: &Channel) -> bool {
        let alike = self.with(channel).is_none_or(|(low, high)| high < MAX_RATIO * low);
        self.unit == channel.unit && self.lines.len() < MAX_LINES && alike
    }

    fn add(&mut self, channel: &'a Channel, label: String) {
        self.sizes = self.with(channel);
        self.lines.push((&channel.name, label));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, unit: &str, size: f64) -> Channel {
        Channel { name: name.into(), unit: unit.into(), values: vec![0.0, size] }
    }

    /// Quantity and labels of a picture.
    type Told = (String, Vec<String>);

    /// Heading, then pictures.
    fn told(channels: &[Channel]) -> Vec<(String, Vec<Told>)> {
        let all: Vec<&Channel> = channels.iter().collect();
        let labels = |p: Picture| (p.quantity, p.lines.into_iter().map(|(_, label)| label).collect());
        let chapter = |c: Chapter| (c.components.join(", "), c.pictures.into_iter().map(labels).collect());
        chapters(&all).into_iter().map(chapter).collect()
    }

    #[test]
    fn what_is_at_several_places_has_a_picture_and_alike_components_a_chapter() {
        let found = told(&[
            channel("car.speed", "m/s", 30.0),
            channel("car.front_left.wheel_speed", "rad/s", 90.0),
            channel("car.front_left.force_z", "N", 4e3),
            channel("car.front_right.wheel_speed", "rad/s", 91.0),
            channel("car.front_right.force_z", "N", 4e3),
            channel("brake_l.torque", "N.m", 900.0),
            channel("abs.valve_1", "1", 1.0),
            channel("abs.valve_2", "1", 1.0),
            channel("brake_r.torque", "N.m", 1.0),
        ]);
        let of = |quantity: &str, labels: &[&str]| {
            (quantity.to_owned(), labels.iter().map(|l| (*l).to_owned()).collect::<Vec<_>>())
        };
        assert_eq!(
            found,
            [
                (
                    "car".to_owned(),
                    vec![
                        of("car.speed", &["car.speed"]),
                        of("wheel speed", &["front_left", "front_right"]),
                        of("force z", &["front_left", "front_right"]),
                    ]
                ),
                // they are of the same kind, but not of the same size
                ("brake_l, brake_r".to_owned(), vec![of("torque", &["brake_l"]), of("torque", &["brake_r"])]),
                ("abs".to_owned(), vec![of("valve", &["valve_1", "valve_2"])]),
            ]
        );
    }

    #[test]
    fn names_without_places_are_together_by_unit() {
        let found = told(&[
            channel("valve_1", "1", 1.0),
            channel("force", "N", 10.0),
            channel("share", "1", 0.5),
            channel("large", "N", 1e4),
        ]);
        let [(heading, pictures)] = &found[..] else { panic!("{found:?}") };
        assert_eq!(heading, "");
        let quantities: Vec<&str> = pictures.iter().map(|(quantity, _)| quantity.as_str()).collect();
        assert_eq!(quantities, ["value", "force", "large"]);
    }
}
