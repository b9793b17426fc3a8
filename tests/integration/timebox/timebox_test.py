#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Unmodified programs in simulated time: what they see is what arithmetic says, and the same each time."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

GRIDSPACE = pathlib.Path(os.environ["GRIDSPACE_BIN_DIR"]) / "gridspace"
EPOCH = 1_575_158_400

ABSOLUTE = """
#define _GNU_SOURCE
#include <stdio.h>
#include <time.h>
int main(void) {
    for (long k = 1; k <= 4800; ++k) { /* a publisher of 4800 Hz */
        long ns = k * 1000000000L / 4800;
        struct timespec t = {ns / 1000000000L, ns % 1000000000L};
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL);
        clock_gettime(CLOCK_REALTIME, &t);
        printf("%ld.%09ld\\n", (long)t.tv_sec, t.tv_nsec);
    }
    return 3;
}
"""

SLEEPS = r"""
#include <limits.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
static int ends[2];
static void nothing(int s) { (void)s; }
static long ms(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec * 1000 + t.tv_nsec / 1000000; }
static void *say(void *unused) { if (write(ends[1], "x", 1) != 1) exit(2); return unused; }
static void *end_all(void *unused) { usleep(500000); printf("ended at %ld ms\n", ms()); exit(0); return unused; }
int main(void) {
    signal(SIGALRM, nothing);
    struct itimerval every = {{0, 300000}, {0, 300000}}, never = {{0, 0}, {0, 0}};
    setitimer(ITIMER_REAL, &every, NULL);
    struct timespec left = {1, 0}, for_ever = {LONG_MAX, 0};
    int times = 0;
    while (nanosleep(&left, &left) != 0) ++times;
    setitimer(ITIMER_REAL, &never, NULL);
    printf("interrupted %d times, awake at %ld ms\n", times, ms());
    if (pipe(ends) != 0) return 1;
    pthread_t other;
    pthread_create(&other, NULL, say, NULL);
    struct pollfd looks = {ends[0], POLLIN, 0};
    while (poll(&looks, 1, 0) == 0) { }
    puts("something came");
    pthread_create(&other, NULL, end_all, NULL);
    nanosleep(&for_ever, NULL);
    puts("for ever is over");
    return 1;
}
"""

KILLED = """
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
static void *sleep_long(void *unused) { sleep(100); return unused; }
static void *end_all(void *unused) { usleep(10000); exit(7); return unused; }
int main(void) {
    pid_t child = fork();
    if (child == 0) { /* two threads, both asleep when they are killed */
        pthread_t other;
        pthread_create(&other, NULL, sleep_long, NULL);
        sleep_long(NULL);
    }
    usleep(10000);
    kill(child, SIGKILL);
    int status;
    waitpid(child, &status, 0);
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    printf("killed by %d at %ld ms\\n", WTERMSIG(status), t.tv_nsec / 1000000);
    pthread_t others[3];
    for (int i = 0; i < 3; ++i) pthread_create(&others[i], NULL, i == 1 ? end_all : sleep_long, NULL);
    pthread_join(others[0], NULL);
    return 1;
}
"""

MASKED = """
#define _GNU_SOURCE
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <time.h>
#include <unistd.h>
static volatile int heard;
static void hear(int s) { heard = s; }
static long ms(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec * 1000 + t.tv_nsec / 1000000; }
int main(void) { /* a signal that is let in only while it waits: ppoll, pselect and epoll_pwait are made for that */
    sigset_t usr1, none;
    sigemptyset(&none); sigemptyset(&usr1); sigaddset(&usr1, SIGUSR1);
    sigprocmask(SIG_BLOCK, &usr1, NULL);
    struct sigaction a = {.sa_handler = hear};
    sigaction(SIGUSR1, &a, NULL);
    pid_t parent = getpid();
    if (fork() == 0) {
        for (int i = 0; i < 2; ++i) { usleep(100000); kill(parent, SIGUSR1); }
        return 0;
    }
    struct timespec second = {1, 0};
    int r = ppoll(NULL, 0, &second, &none);
    printf("ppoll %d %s %d at %ld ms\\n", r, errno == EINTR ? "EINTR" : "?", heard == SIGUSR1, ms());
    heard = 0;
    struct pollfd nothing = {-1, POLLIN, 0};
    r = poll(&nothing, 1, 50);
    printf("poll %d %d at %ld ms\\n", r, heard, ms());
    usleep(100000); /* it comes meanwhile, and is kept */
    r = pselect(0, NULL, NULL, NULL, &second, &none);
    printf("pselect %d %s %d at %ld ms\\n", r, errno == EINTR ? "EINTR" : "?", heard == SIGUSR1, ms());
    heard = 0;
    int e = epoll_create1(0);
    struct epoll_event event;
    r = epoll_pwait(e, &event, 1, 50, &none);
    printf("epoll_pwait %d %d at %ld ms\\n", r, heard, ms());
    struct pollfd closed = {77, POLLIN, 0};
    r = poll(&closed, 1, 50);
    fd_set set;
    FD_ZERO(&set); FD_SET(77, &set);
    int b = select(78, &set, NULL, NULL, NULL);
    printf("closed: poll %d %d, select %d %s\\n", r, closed.revents == POLLNVAL, b, errno == EBADF ? "EBADF" : "?");
    return 0;
}
"""

# Takes the one place for a listener to notifications of seccomp, and becomes the command.
TAKEN = """
import ctypes, fcntl, os, struct, sys
libc = ctypes.CDLL(None, use_errno=True)
allow = ctypes.create_string_buffer(struct.pack("HBBI", 0x06, 0, 0, 0x7FFF0000), 8)  # BPF_RET | BPF_K, SECCOMP_RET_ALLOW
program = ctypes.create_string_buffer(struct.pack("H6xQ", 1, ctypes.addressof(allow)), 16)
libc.prctl(38, 1, 0, 0, 0)  # PR_SET_NO_NEW_PRIVS
listener = libc.syscall(317, 1, 8, program)  # seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER
assert listener >= 0, os.strerror(ctypes.get_errno())
fcntl.fcntl(listener, fcntl.F_SETFD, 0)
os.execv(sys.argv[1], sys.argv[1:])
"""

THREADS = """
#include <pthread.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>
static pthread_mutex_t m = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t c = PTHREAD_COND_INITIALIZER;
static int waiting;
static void *produce(void *period_us) {
    for (int i = 0; i < 5; ++i) {
        usleep((useconds_t)(long)period_us);
        pthread_mutex_lock(&m); ++waiting; pthread_cond_signal(&c); pthread_mutex_unlock(&m);
    }
    return NULL;
}
int main(void) {
    pthread_t p[3];
    for (long i = 0; i < 3; ++i) pthread_create(&p[i], NULL, produce, (void *)(100000 * (i + 1)));
    for (int got = 0; got < 15;) {
        pthread_mutex_lock(&m);
        while (!waiting) {
            struct timespec t;
            clock_gettime(CLOCK_REALTIME, &t);
            t.tv_nsec += 60000000;
            if (t.tv_nsec >= 1000000000) { t.tv_nsec -= 1000000000; ++t.tv_sec; }
            if (pthread_cond_timedwait(&c, &m, &t)) { struct timespec n; clock_gettime(CLOCK_MONOTONIC, &n); printf("none by %ld ms\\n", n.tv_sec * 1000 + n.tv_nsec / 1000000); }
        }
        --waiting; ++got;
        pthread_mutex_unlock(&m);
        struct timespec n; clock_gettime(CLOCK_MONOTONIC, &n);
        printf("%d at %ld ms\\n", got, n.tv_sec * 1000 + n.tv_nsec / 1000000);
    }
    for (int i = 0; i < 3; ++i) pthread_join(p[i], NULL);
    return 0;
}
"""

EPOLL = """
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>
static long us(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return t.tv_sec * 1000000 + t.tv_nsec / 1000; }
int main(void) {
    int e = epoll_create1(0), t = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK);
    struct itimerspec s = {{0, 250000}, {0, 250000}};
    timerfd_settime(t, 0, &s, NULL);
    struct epoll_event event = {EPOLLIN, {.fd = t}};
    epoll_ctl(e, EPOLL_CTL_ADD, t, &event);
    uint64_t rung = 0, n;
    while (rung < 400) {
        if (epoll_wait(e, &event, 1, 1000) != 1 || read(t, &n, 8) != 8) return 1;
        rung += n;
    }
    printf("%lu at %ld us\\n", (unsigned long)rung, us());
    for (int i = 0; i < 100; ++i) poll(NULL, 0, 1);
    printf("polled until %ld us\\n", us());
    return 0;
}
"""

PYTHON = """
import asyncio, os, queue, random, select, signal, socket, subprocess, threading, time
begin = time.monotonic()
now = lambda: round(time.monotonic() - begin, 2)
print(now(), random.random(), os.urandom(4).hex())
def work(n):
    for i in range(3):
        time.sleep(0.1 * (n + 1))
        print(now(), n, i, flush=True)
threads = [threading.Thread(target=work, args=(n,)) for n in range(3)]
for t in threads: t.start()
for t in threads: t.join()
try: queue.Queue().get(timeout=5)
except queue.Empty: print(now(), "empty")
print(now(), subprocess.run(["sh", "-c", "sleep 2; date -u +%s"], capture_output=True, text=True).stdout.strip(), now())
r, w = os.pipe()
print(select.select([r], [], [], 0.5), now())
signal.signal(signal.SIGALRM, lambda *_: print(now(), "alarm"))
signal.setitimer(signal.ITIMER_REAL, 3, 0)
time.sleep(10)
print(now())
a, b = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
a.settimeout(1.5)
try: a.recv(10)
except TimeoutError: print(now(), "nothing came")
threading.Timer(0.25, lambda: b.send(b"something")).start()
print(a.recv(10), now())
async def two():
    await asyncio.gather(asyncio.sleep(0.3), asyncio.sleep(0.7))
asyncio.run(two())
print(now())
"""

LOOKS = r"""
#define _GNU_SOURCE
#include <pthread.h>
#include <stdio.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>
#ifdef CALLS
#define LOOK(clock, t) syscall(SYS_clock_gettime, clock, t)
#define DAY(t) syscall(SYS_gettimeofday, t, NULL)
#define SECONDS() (long)syscall(SYS_time, NULL)
#else
#define LOOK(clock, t) clock_gettime(clock, t)
#define DAY(t) gettimeofday(t, NULL)
#define SECONDS() (long)time(NULL)
#endif
static void *waiter(void *name) { /* one that waits by looking, beside others */
    struct timespec t = {0, 0};
    for (long until = 20000; until < 200000; until += 30000) {
        long looks = 0;
        do { LOOK(CLOCK_MONOTONIC, &t); ++looks; } while (t.tv_sec == 0 && t.tv_nsec < until);
        printf("%s %ld.%09ld after %ld\n", (char *)name, (long)t.tv_sec, t.tv_nsec, looks);
    }
    return NULL;
}
int main(void) {
    struct timespec t, s = {0, 7777};
    struct timeval v;
    pthread_t p[2];
    pthread_create(&p[0], NULL, waiter, "a");
    pthread_create(&p[1], NULL, waiter, "b");
    for (int i = 0; i < 40; ++i) {
        for (int clock = 0; clock < 12; ++clock) {
            if (clock == 10) continue;
            LOOK(clock, &t);
            printf("%d %ld.%09ld\n", clock, (long)t.tv_sec, t.tv_nsec);
        }
        DAY(&v);
        printf("%ld.%06ld %ld\n", (long)v.tv_sec, (long)v.tv_usec, SECONDS());
        nanosleep(&s, NULL);
    }
    pthread_join(p[0], NULL);
    pthread_join(p[1], NULL);
    return 0;
}
"""

DRAWS = """
from random import SystemRandom
import os, subprocess
for name in ("/dev/urandom", "/dev/random"):
    with open(name, "rb", buffering=0) as f: print(f.read(8).hex(), f.read(3).hex())
    with open(name, "rb") as f: print(f.read(5000)[-4:].hex())
print(open(os.open("/dev/urandom", os.O_RDONLY | os.O_NONBLOCK), "rb").read(2).hex(), SystemRandom().random())
print(os.getpid(), subprocess.run(["sh", "-c", "echo $$ $PPID; kill -0 $$ && sleep 0.1 & wait $!; echo $? $!"], capture_output=True, text=True).stdout.split())
"""


class Timebox(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="gridspace-timebox-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def compiled(self, source, *options):
        (self.folder / "program.c").write_text(source)
        subprocess.run(["cc", "-O1", "-pthread", *options, "program.c", "-o", "program"], cwd=self.folder, check=True)
        return str(self.folder / "program")

    def box(self, *command, options=()):
        return subprocess.run([GRIDSPACE, "timebox", *options, "--", *command], capture_output=True, text=True, stdin=subprocess.DEVNULL, timeout=300)

    def test_a_program_that_sleeps_to_absolute_deadlines_wakes_at_them_whether_linked_statically_or_not(self):
        for options in ((), ("-static",)):
            done = self.box(self.compiled(ABSOLUTE, *options))
            stamps = done.stdout.splitlines()
            self.assertEqual(done.returncode, 3, "the program's own")
            self.assertEqual(stamps, [f"{EPOCH + k * 10**9 // 4800 // 10**9}.{k * 10**9 // 4800 % 10**9:09d}" for k in range(1, 4801)])
            self.assertIn("1.000000100 s simulated", done.stderr, "the last look took 100 ns")

    def test_an_interrupted_sleep_says_what_is_left_one_for_ever_lasts_and_who_only_looks_lets_others_act(self):
        done = self.box(self.compiled(SLEEPS))
        self.assertEqual(done.stdout, "interrupted 3 times, awake at 1000 ms\nsomething came\nended at 1500 ms\n", done.stderr)
        self.assertEqual(done.returncode, 0)

    def test_threads_with_a_condition_variable_meet_at_the_instants_that_arithmetic_says(self):
        lines = self.box(self.compiled(THREADS)).stdout.splitlines()
        got = [int(line.split()[2]) for line in lines if " at " in line]
        self.assertEqual(got, sorted(100 * (n + 1) * (i + 1) for n in range(3) for i in range(5)))
        self.assertEqual(lines[0], "none by 60 ms")
        self.assertNotEqual([line for line in lines if line.startswith("none by 1260")], [])

    def test_epoll_with_a_timerfd_and_poll_keep_their_periods(self):
        self.assertEqual(self.box(self.compiled(EPOLL)).stdout, "400 at 100000 us\npolled until 200000 us\n")

    def test_python_with_threads_processes_signals_and_sockets_ends_at_the_same_instant_with_the_same_random_numbers_each_time(self):
        (self.folder / "program.py").write_text(PYTHON)
        first, again, other = (self.box("python3", str(self.folder / "program.py"), options=("--seed", seed)) for seed in ("7", "7", "8"))
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stdout, again.stdout)
        self.assertNotEqual(first.stdout.splitlines()[0], other.stdout.splitlines()[0])
        self.assertEqual(first.stdout.splitlines()[1:], other.stdout.splitlines()[1:])
        said = first.stdout.splitlines()
        for line in ("5.9 empty", "([], [], []) 8.4", "11.4 alarm", "18.4", "19.9 nothing came", "b'something' 20.15", "20.85"):
            self.assertIn(line, said)
        self.assertTrue(any(line.startswith(f"5.9 {EPOCH + 7}") for line in said), said)

    def test_a_signal_that_only_the_mask_of_a_wait_lets_in_ends_it(self):
        self.assertEqual(self.box(self.compiled(MASKED)).stdout,
                         "ppoll -1 EINTR 1 at 100 ms\npoll 0 0 at 150 ms\npselect -1 EINTR 1 at 250 ms\n"
                         "epoll_pwait 0 0 at 300 ms\nclosed: poll 1 1, select -1 EBADF\n")

    def test_where_somebody_else_hears_notifications_calls_stop_under_ptrace_and_give_the_same(self):
        (self.folder / "program.py").write_text(PYTHON)
        for source in (None, THREADS, MASKED):
            command = (self.compiled(source),) if source else ("python3", str(self.folder / "program.py"))
            usual = self.box(*command)
            taken = subprocess.run(["python3", "-c", TAKEN, str(GRIDSPACE), "timebox", "--", *command], capture_output=True, text=True,
                                   stdin=subprocess.DEVNULL, timeout=60, check=False)
            self.assertEqual((taken.returncode, taken.stdout), (usual.returncode, usual.stdout), taken.stderr)
            told = r"[0-9.]+ s simulated|\d+ calls held"
            self.assertEqual(re.findall(told, taken.stderr), re.findall(told, usual.stderr))

    def test_looks_at_the_clock_in_the_program_show_what_calls_would_and_are_counted_like_them(self):
        fast, calls = (self.box(self.compiled(LOOKS, *options)) for options in ((), ("-DCALLS",)))
        self.assertGreater(len(fast.stdout.splitlines()), 480)
        self.assertEqual(fast.stdout, calls.stdout)
        of = r"(\d+\.\d+ s simulated) in \S+ s; (.*)"
        self.assertEqual(re.search(of, fast.stderr).groups(), re.search(of, calls.stderr).groups())
        self.assertNotIn("after 1\n", fast.stdout, "it does look many times")

    def test_random_files_are_of_the_seed_and_process_numbers_the_same_each_time(self):
        first, again, other = (self.box("python3", "-c", DRAWS, options=("--seed", seed)) for seed in ("7", "7", "8"))
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stdout, again.stdout)
        drawn = first.stdout.split()[:8]
        self.assertEqual([d for d in drawn if d in other.stdout.split()], [], "another seed, other octets")
        self.assertEqual(len(set(drawn)), 8)
        self.assertEqual(first.stdout.splitlines()[-1], other.stdout.splitlines()[-1])
        self.assertEqual(first.stdout.splitlines()[-1], "2 ['3', '2', '0', '4']")

    def test_until_ends_it_and_trace_lists_the_held_calls(self):
        done = self.box("sleep", "100", options=("--until", "5", "--trace"))
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        self.assertIn("5.000000000 s simulated", done.stderr)
        done = self.box("sh", "-c", "sleep 1; sleep 2", options=("--trace",))
        self.assertRegex(done.stderr, r"1\.0\d+ s  thread 2 +clock_nanosleep +held 1\.000000000 s")

    def test_what_cannot_be_is_refused_and_said(self):
        code = """
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
try: s.setsockopt(socket.SOL_SOCKET, 35, 1)
except OSError as e: print(e.errno)
"""
        done = self.box("python3", "-c", code)
        self.assertEqual(done.stdout, "92\n")
        self.assertIn("refused 1 time: SO_TIMESTAMP", done.stderr)

    def test_a_loop_without_calls_a_deadlock_and_a_missing_program_end_with_a_reason(self):
        done = self.box("python3", "-c", "while True: pass", options=("--patience", "1"))
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"python3\S* \(\d+\) has computed for \d+ s without a call")
        done = self.box("python3", "-c", "import threading; x = threading.Lock(); x.acquire(); x.acquire()")
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"nothing can happen any more at 0\.\d+ s: python3\S* \(\d+\) in futex")
        done = self.box("/no/such/program")
        self.assertEqual(done.returncode, 3)
        self.assertIn("cannot start '/no/such/program': No such file or directory", done.stderr)

    def test_a_program_that_dies_of_a_signal_has_the_exit_code_of_a_shell(self):
        self.assertEqual(self.box("sh", "-c", "kill -SEGV $$").returncode, 139)

    def test_who_is_killed_while_he_waits_is_gone_before_time_goes_on(self):
        """Another thread's exit() ends a process whose first thread waits; a killed child has died at that instant."""
        program = self.compiled(KILLED)
        for _ in range(10):
            done = self.box(program)
            self.assertEqual((done.returncode, done.stdout), (7, "killed by 9 at 10 ms\n"), done.stderr)
            self.assertRegex(done.stderr, r"0\.0200\d+ s simulated")

    def test_what_comes_from_outside_is_waited_for(self):
        done = subprocess.run([GRIDSPACE, "timebox", "-q", "--", "cat"], input="from outside\n", capture_output=True, text=True, timeout=60)
        self.assertEqual(done.stdout, "from outside\n")


if __name__ == "__main__":
    unittest.main()
