use super::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// Works until it is stopped.
fn endless() {
    while !is_stopped() {
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn within(milliseconds: u64) -> Watch {
    Watch::new(Limits {
        time: Some(Duration::from_millis(milliseconds)),
        ..Limits::default()
    })
}

#[test]
fn work_that_is_done_in_time_has_its_result() {
    assert_eq!(within(60_000).run(|| 7), Ok(7));
    // The watch is gone.
    assert_eq!(go_on(), Ok(()));
    assert!(Watch::current().is_none());
}

#[test]
fn work_without_end_is_stopped_and_says_what_it_was_at() {
    let stopped = within(100)
        .run(|| {
            layers_done(3, 40);
            doing("infill", endless);
        })
        .unwrap_err();
    assert_eq!(stopped.reason, Reason::Time);
    let text = stopped.to_string();
    assert!(text.contains("0.1 s"), "{text}");
    assert!(text.contains("3 of 40 layers"), "{text}");
    assert!(
        text.contains("100 % of the time went into infill"),
        "{text}"
    );
    assert!(text.contains("infill_density"), "{text}");
}

/// Keeps the processor busy until it is stopped.
fn busy() {
    while !is_stopped() {
        std::hint::black_box((0..1000).sum::<u64>());
    }
}

const SLOW: Slow = Slow {
    work: Duration::from_millis(100),
    points: 50,
};

#[test]
fn work_of_which_nothing_comes_is_stopped() {
    let watch = Watch::new(Limits {
        slow: Some(SLOW),
        ..Limits::default()
    });
    // The work makes points at first, and then none.
    let stopped = watch.run(|| {
        made(1000);
        doing("contour", busy);
    });
    let stopped = stopped.unwrap_err();
    assert_eq!(stopped.reason, Reason::Slow);
    let text = stopped.to_string();
    assert!(text.contains("0.1 s of processor time"), "{text}");
    assert!(text.contains("--time-limit 8h"), "{text}");
}

#[test]
fn work_that_makes_enough_is_not_slow() {
    let watch = Watch::new(Limits {
        work: Some(5 * SLOW.work),
        slow: Some(SLOW),
        ..Limits::default()
    });
    let stopped = watch.run(|| {
        doing("walls", || {
            while !is_stopped() {
                made(5);
            }
        });
    });
    let stopped: Stopped = stopped.unwrap_err();
    assert_eq!(stopped.reason, Reason::Work);
    let text = stopped.to_string();
    assert!(text.contains("of processor time"), "{text}");
}

/// A run that waits for the processor, or is paused (Ctrl-Z), does no work.
#[test]
fn waiting_is_no_work() {
    let watch = Watch::new(Limits {
        work: Some(SLOW.work),
        slow: Some(SLOW),
        ..Limits::default()
    });
    let done = watch.run(|| {
        for _ in 0..60 {
            assert!(!is_stopped());
            std::thread::sleep(Duration::from_millis(5));
        }
        7
    });
    assert_eq!(done, Ok(7));
}

#[test]
fn the_work_of_other_threads_does_not_count() {
    let limits = Limits {
        work: Some(SLOW.work),
        ..Limits::default()
    };
    let others = Watch::new(Limits::default());
    std::thread::scope(|scope| {
        let other = scope.spawn(|| others.run(busy));
        // Other work that goes on for three times the limit.
        let done = Watch::new(limits).run(|| {
            while others.0.work() < 3 * SLOW.work {
                assert!(!is_stopped());
                std::thread::sleep(Duration::from_millis(5));
            }
        });
        others.cancel();
        assert_eq!(done, Ok(()));
        assert!(other.join().unwrap().is_err());
    });
}

#[test]
fn threads_of_a_pool_stop_with_it() {
    use rayon::prelude::*;
    let stopped = within(100).run(|| {
        let watch = Watch::current();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .start_handler(move |_| Watch::adopt(watch.as_ref()))
            .build()
            .unwrap();
        pool.install(|| {
            (0..8).into_par_iter().for_each(|_| doing("walls", endless));
        });
    });
    assert_eq!(stopped.unwrap_err().reason, Reason::Time);
}

#[test]
fn too_much_memory_stops_it() {
    let watch = Watch::new(Limits {
        time: Some(Duration::from_secs(60)),
        memory_bytes: Some(1),
        ..Limits::default()
    });
    let stopped = watch.run(endless).unwrap_err();
    if resident_bytes().is_some() {
        assert_eq!(stopped.reason, Reason::Memory);
        assert!(stopped.to_string().contains("--memory-limit"));
    }
}

#[test]
fn another_thread_can_stop_it() {
    let watch = within(60_000);
    let other = watch.clone();
    let stopper = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(50));
        other.cancel();
    });
    let stopped = watch.run(endless).unwrap_err();
    assert_eq!(stopped.reason, Reason::Cancelled);
    stopper.join().unwrap();
}

#[test]
fn the_last_resort_comes_when_nothing_looks() {
    let (sender, receiver) = std::sync::mpsc::channel();
    let sender = Mutex::new(sender);
    let resort = |stopped: &Stopped| {
        sender.lock().unwrap().send(stopped.reason).unwrap();
    };
    // The work waits for the last resort and never checks the flag.
    let result =
        within(50).last_resort(Duration::from_millis(50), &resort, || {
            receiver.recv_timeout(Duration::from_secs(60))
        });
    assert_eq!(result, Ok(Ok(Reason::Time)));
}

#[test]
fn a_real_panic_stays_one() {
    let watch = within(60_000);
    let result = catch_unwind(AssertUnwindSafe(|| {
        let _ = watch.run(|| resume_unwind(Box::new(5_i32)));
    }));
    assert_eq!(result.unwrap_err().downcast_ref(), Some(&5_i32));
    // The watch is gone, and its second thread has ended.
    assert!(Watch::current().is_none());
}

/// Work that did not see in time that it was to stop is whole.
#[test]
fn only_work_that_saw_the_flag_is_stopped() {
    let watch = within(60_000);
    let unseen = watch.run(|| {
        assert!(!is_stopped());
        watch.cancel();
        7
    });
    assert_eq!(unseen, Ok(7));
    let watch = within(60_000);
    watch.cancel_after(3);
    let seen = watch.run(|| {
        assert_eq!((0..9).take_while(|_| !is_stopped()).count(), 2);
        // Nothing that was stopped takes a file's place.
        assert!(io_goes_on().is_err());
        go_on()
    });
    assert_eq!(seen.unwrap_err().reason, Reason::Cancelled);
}
