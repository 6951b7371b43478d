//! What the studio waits for: an edit to its clip, beside the window as the studio bakes it, and the window's own work a frame without
//! drawing. `cargo bench --bench studio`; `surefoot studio --measure 10` measures the same in a real window.

use divan::Bencher;
use std::sync::Arc;
use std::time::{Duration, Instant};
use surefoot::model::Scenario;
use surefoot::studio::document::Document;
use surefoot::studio::simulate::{self, Answer, Question};

fn main() {
    divan::main();
}

/// 5 s of the built-in rig: an edit to the clip that shows it.
#[divan::bench(args = ["stand and shove", "walk and shove"], sample_count = 30)]
fn edit_to_clip(bencher: Bencher, what: &str) {
    let mut scenario = Scenario { duration: 5.0, ..Scenario::demo() };
    if what.starts_with("walk") {
        scenario.walk.push(surefoot::model::scenario::Walk {
            start: 0.2,
            duration: None,
            speed: 1.2,
            heading: 0.0,
            facing: None,
        });
    }
    let worker = simulate::start(Arc::new(|| {}));
    let mut edit = 0;
    bencher.bench_local(|| {
        edit += 1;
        scenario.push[0].force += 1.0;
        let document = Document::of("builtin".into(), scenario.clone());
        worker.ask_only(Question { edit, document, file: None, asked: Instant::now() });
        loop {
            if worker.answers().iter().any(|answer| matches!(answer, Answer::Clip(shown) if shown.edit == edit)) {
                break;
            }
            std::thread::sleep(Duration::from_micros(200));
        }
    });
}
