//! The same for many things, on several threads.

use std::sync::atomic::{AtomicUsize, Ordering};

/// What `of` makes of each item, in their order. So many threads take the next one each whenever they are free; an item
/// whose thread fails has no answer.
pub fn side_by_side<T: Sync, R: Send>(
    threads: usize,
    items: &[T],
    of: impl Fn(&T) -> R + Sync,
) -> Vec<Option<R>> {
    let next = AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        while let Some((i, item)) = {
            let i = next.fetch_add(1, Ordering::Relaxed);
            items.get(i).map(|item| (i, item))
        } {
            done.push((i, of(item)));
        }
        done
    };
    let mut answers: Vec<Option<R>> = items.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, items.len().max(1))).map(|_| scope.spawn(work)).collect();
        for (i, answer) in workers
            .into_iter()
            .flat_map(|w| w.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        {
            answers[i] = Some(answer);
        }
    });
    answers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..100).collect();
        for threads in [0, 1, 3, 200] {
            let squares: Vec<usize> =
                side_by_side(threads, &items, |i| i * i).into_iter().flatten().collect();
            assert!(squares.len() == 100 && squares.iter().enumerate().all(|(i, s)| *s == i * i));
        }
        assert!(side_by_side(2, &[0_u8; 0], |i| *i).is_empty());
    }
}
