// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
// Waits in every way that Java has, and says when each ended.
import java.time.Instant;
import java.time.temporal.ChronoUnit;
import java.util.concurrent.*;
import java.util.concurrent.locks.LockSupport;

public class Clocks {
    static final long start = System.nanoTime();

    static void say(String what) {
        System.out.println(what + " " + (System.nanoTime() - start) / 1_000_000 + " ms");
    }

    public static void main(String[] arguments) throws Exception {
        System.out.println("today " + Instant.now().truncatedTo(ChronoUnit.DAYS));
        Thread.sleep(10);
        say("slept");
        LockSupport.parkNanos(20_000_000);
        say("parked");
        Object monitor = new Object();
        synchronized (monitor) {
            monitor.wait(30);
        }
        say("monitor timed out");
        BlockingQueue<Integer> queue = new LinkedBlockingQueue<>();
        System.out.println(queue.poll(40, TimeUnit.MILLISECONDS));
        say("nobody came");
        ScheduledExecutorService timer = Executors.newSingleThreadScheduledExecutor();
        CountDownLatch latch = new CountDownLatch(10);
        timer.scheduleAtFixedRate(latch::countDown, 5, 5, TimeUnit.MILLISECONDS);
        latch.await();
        say("ticked");
        timer.shutdownNow();
        for (int i = 1; i <= 3; ++i) {
            int n = i;
            new Thread(() -> {
                try {
                    Thread.sleep(40 - 10 * n);
                } catch (InterruptedException e) {
                    throw new RuntimeException(e);
                }
                queue.add(n);
            }).start();
        }
        for (int i = 0; i < 3; ++i) {
            say("thread " + queue.take());
        }
        System.out.println(CompletableFuture.supplyAsync(() -> 1).orTimeout(1, TimeUnit.SECONDS).get());
        Process child = new ProcessBuilder("sleep", "10").start();
        System.out.println(child.waitFor(200, TimeUnit.MILLISECONDS));
        say("child waited for");
        child.destroy();
        child.waitFor();
        System.out.println("random " + new java.security.SecureRandom().nextLong());
    }
}
