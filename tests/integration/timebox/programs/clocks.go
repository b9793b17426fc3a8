// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
// Waits in every way that Go has, and says when each ended.
package main

import (
	"context"
	"crypto/rand"
	"fmt"
	"net"
	"os"
	"os/exec"
	"path/filepath"
	"sync"
	"time"
)

var start = time.Now()

func say(what string) { fmt.Printf("%s %d ms\n", what, time.Since(start).Milliseconds()) }

func main() {
	fmt.Println("today", start.UTC().Format("2006-01-02T15:04:05"))
	time.Sleep(10 * time.Millisecond)
	say("slept")
	ticker := time.NewTicker(5 * time.Millisecond)
	for i := 0; i < 4; i++ {
		<-ticker.C
	}
	ticker.Stop()
	say("ticked")
	select {
	case <-make(chan int):
	case <-time.After(70 * time.Millisecond):
	}
	say("nobody came")
	results := make(chan int)
	for i := 1; i <= 3; i++ { // the third goroutine is the first
		go func(i int) {
			time.Sleep(time.Duration(40-10*i) * time.Millisecond)
			results <- i
		}(i)
	}
	for i := 0; i < 3; i++ {
		say(fmt.Sprint("goroutine ", <-results))
	}
	var m sync.Mutex
	var group sync.WaitGroup
	for i := 0; i < 4; i++ { // one after the other
		group.Add(1)
		go func() {
			defer group.Done()
			m.Lock()
			time.Sleep(25 * time.Millisecond)
			m.Unlock()
		}()
	}
	group.Wait()
	say("mutex")
	folder, _ := os.MkdirTemp("", "clocks")
	defer os.RemoveAll(folder)
	socket, err := net.ListenUnixgram("unixgram", &net.UnixAddr{Name: filepath.Join(folder, "s"), Net: "unixgram"})
	if err != nil {
		panic(err)
	}
	_ = socket.SetReadDeadline(time.Now().Add(170 * time.Millisecond))
	_, err = socket.Read(make([]byte, 8))
	say(fmt.Sprint("socket timed out: ", err.(net.Error).Timeout()))
	ctx, cancel := context.WithTimeout(context.Background(), 200*time.Millisecond)
	defer cancel()
	err = exec.CommandContext(ctx, "sleep", "10").Run()
	say(fmt.Sprint("child: ", err))
	sum := 0
	for i := 0; i < 200_000_000; i++ { // computing takes no time
		sum += i
	}
	say(fmt.Sprint("computed ", sum))
	octets := make([]byte, 8)
	_, _ = rand.Read(octets)
	fmt.Printf("random %x\n", octets)
}
