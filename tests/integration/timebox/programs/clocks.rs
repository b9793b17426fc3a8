// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
// Waits in every way that Rust's library has, and says when each ended.
use std::collections::hash_map::RandomState;
use std::hash::{BuildHasher, Hasher};
use std::os::unix::net::UnixDatagram;
use std::sync::{mpsc, Arc, Condvar, Mutex};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

fn ms(n: u64) -> Duration {
    Duration::from_millis(n)
}

fn main() {
    let start = Instant::now();
    let say = |what: &str| println!("{} {} ms", what, start.elapsed().as_millis());
    println!("today {}", SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs());
    thread::sleep(ms(10));
    say("slept");
    let (sender, receiver) = mpsc::channel();
    assert!(receiver.recv_timeout(ms(20)).is_err());
    say("nobody came");
    for i in 1..4u64 {
        let sender = sender.clone();
        thread::spawn(move || {
            thread::sleep(ms(40 - 10 * i));
            sender.send(i).unwrap();
        });
    }
    for _ in 0..3 {
        say(&format!("thread {}", receiver.recv().unwrap()));
    }
    let pair = Arc::new((Mutex::new(0), Condvar::new()));
    let workers: Vec<_> = (0..4)
        .map(|_| {
            let pair = Arc::clone(&pair);
            thread::spawn(move || {
                let mut n = pair.0.lock().unwrap();
                thread::sleep(ms(25)); // one after the other
                *n += 1;
                pair.1.notify_one();
            })
        })
        .collect();
    let mut n = pair.0.lock().unwrap();
    while *n < 4 {
        n = pair.1.wait(n).unwrap();
    }
    say("condition");
    let (n, timeout) = pair.1.wait_timeout(n, ms(30)).unwrap();
    say(&format!("timed out: {}", timeout.timed_out()));
    drop(n);
    for worker in workers {
        worker.join().unwrap();
    }
    thread::park_timeout(ms(15));
    say("parked");
    let (a, _b) = UnixDatagram::pair().unwrap();
    a.set_read_timeout(Some(ms(100))).unwrap();
    assert!(a.recv(&mut [0; 8]).is_err());
    say("socket timed out");
    println!("random {:x}", RandomState::new().build_hasher().finish());
}
