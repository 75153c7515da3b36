//! Drawings that look the same and are shorter: fewer points, and lines as steps.

/// Fewer points that look the same: of neighbours that fall into one column of the plot only those
/// with the smallest and largest x and y are kept, in their order, so that no peak is lost. Where x
/// goes forth and back, columns are stretches of the curve of about equal number of points.
pub(super) fn thin_out(points: &[(f64, f64)], low: f64, high: f64, columns: usize) -> Vec<(f64, f64)> {
    if points.len() <= 2 * columns {
        return straighten(points.to_vec());
    }
    let forward = points.windows(2).all(|w| w[0].0 <= w[1].0);
    let column = |i: usize| {
        let share = if forward { (points[i].0 - low) / (high - low) } else { i as f64 / points.len() as f64 };
        (share * columns as f64) as usize
    };
    let mut kept = Vec::new();
    let mut start = 0;
    while start < points.len() {
        let end = (start..points.len()).find(|i| column(*i) != column(start)).unwrap_or(points.len());
        let mut keep = [start; 4];
        for i in start..end {
            let is_better = [
                points[i].0 < points[keep[0]].0,
                points[i].0 >= points[keep[1]].0,
                points[i].1 < points[keep[2]].1,
                points[i].1 > points[keep[3]].1,
            ];
            for (kept, better) in keep.iter_mut().zip(is_better) {
                if better {
                    *kept = i;
                }
            }
        }
        keep.sort_unstable();
        let mut last = None;
        for i in keep {
            if last != Some(i) {
                kept.push(points[i]);
                last = Some(i);
            }
        }
        start = end;
    }
    straighten(kept)
}

/// Leaves out points between two others of the same y or the same x.
fn straighten(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        if let (Some(before), Some(after)) = (kept.last(), points.get(i + 1)) {
            let between = |a: f64, b: f64, c: f64| (a <= b && b <= c) || (a >= b && b >= c);
            let level = before.1 == point.1 && point.1 == after.1 && between(before.0, point.0, after.0);
            let upright = before.0 == point.0 && point.0 == after.0 && between(before.1, point.1, after.1);
            if level || upright {
                continue;
            }
        }
        kept.push(*point);
    }
    kept
}

/// The same drawing with its lines as paths of steps from point to point, about half as long.
pub(super) fn shorten(svg: &str) -> String {
    let mut short = String::with_capacity(svg.len());
    let mut rest = svg;
    while let Some((before, line)) = rest.split_once("<polyline ") {
        short.push_str(before);
        let Some((element, after)) = line.split_once("/>") else {
            short.push_str("<polyline ");
            rest = line;
            continue;
        };
        match path(element) {
            Some(path) => short.push_str(&path),
            None => short.push_str(&format!("<polyline {element}/>")),
        }
        rest = after;
    }
    short + rest
}

/// The `path` for the attributes of a `polyline` with whole coordinates.
fn path(element: &str) -> Option<String> {
    let (attributes, points) = element.split_once("points=\"")?;
    let (points, others) = points.split_once('"')?;
    let mut path = format!("<path {attributes}{}d=\"", others.trim_start());
    let mut last: Option<(i32, i32)> = None;
    for point in points.split_whitespace() {
        let (x, y) = point.split_once(',')?;
        let (x, y): (i32, i32) = (x.parse().ok()?, y.parse().ok()?);
        match last {
            None => path.push_str(&format!("M{x} {y}l")),
            Some(last) => {
                for step in [x - last.0, y - last.1] {
                    // a minus sign separates as well as a space
                    if step >= 0 && !path.ends_with('l') {
                        path.push(' ');
                    }
                    path.push_str(&step.to_string());
                }
            }
        }
        last = Some((x, y));
    }
    Some(path + "\"/>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_series_keep_their_extremes() {
        let n = 200_000;
        let time: Vec<f64> = (0..n).map(|i| f64::from(i) * 1e-3).collect();
        let mut points: Vec<(f64, f64)> = time.iter().map(|t| (*t, (3.0 * t).sin())).collect();
        points[123_457].1 = 40.0;
        points[77_777].1 = -30.0;
        // a curve that goes forth and back
        let turning: Vec<(f64, f64)> = points.iter().map(|(t, y)| ((0.05 * t).cos(), *y)).collect();
        for points in [points, turning] {
            let thin = thin_out(&points, -1.0, 200.0, 800);
            assert!(thin.len() <= 4 * (800 + 1), "{}", thin.len());
            for peak in [points[0], points[123_457], points[77_777], points[n as usize - 1]] {
                assert!(thin.contains(&peak), "{peak:?}");
            }
            let mut rest = points.iter();
            assert!(thin.iter().all(|p| rest.any(|q| q == p)), "the order changed");
        }
    }

    #[test]
    fn straight_stretches_need_two_points() {
        let level: Vec<(f64, f64)> = (0..50).map(|i| (f64::from(i), 1.0)).collect();
        assert_eq!(thin_out(&level, 0.0, 50.0, 10), [(0.0, 1.0), (49.0, 1.0)]);
        let back = vec![(0.0, 1.0), (5.0, 1.0), (2.0, 1.0)];
        assert_eq!(straighten(back.clone()), back);
    }

    #[test]
    fn a_short_path_goes_through_the_same_points() {
        let line = "<polyline fill=\"none\" stroke-width=\"4\" points=\"10,20 12,5 12,9 \"/>";
        assert_eq!(
            shorten(&format!("<rect/>{line}<g/>")),
            "<rect/><path fill=\"none\" stroke-width=\"4\" d=\"M10 20l2-15 0 4\"/><g/>"
        );
        let broken = "<polyline points=\"1.5,2\"/>";
        assert_eq!(shorten(broken), broken);
    }
}
