// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A member of Gridspace's lockstep clock, in C over CycloneDDS: docs/reference/lockstep_protocol.md as a program. It
// shares no code with Gridspace, only the IDL. Copy these two files into an agent of your own.
//
//     gs_member *m = gs_join();                                   // 1. reads the environment, joins the two domains
//     gs_reader(m, "bus_measurements", &BusMeasurement_desc, on_measurement, NULL);
//     gs_writer *out = gs_writer_of(m, "requests", &ChargingRequest_desc);
//     gs_start(m);                                                // 2. waits until everybody expected is matched
//     gs_tick tick;
//     while (gs_next(m, &tick)) {                                 // 3. all input up to tick.time_ns has been delivered
//         ... gs_write(m, out, &request, tick.time_ns); ...
//         gs_done(m, &tick, next_tick_needed);
//     }
//     gs_leave(m);
//
// One thread only. A failure prints its reason and ends the process with an exit code of docs/reference/exit_codes.md.
#pragma once

#include <dds/dds.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct gs_member gs_member;
typedef struct gs_writer gs_writer;

typedef struct gs_tick {
    uint64_t number;
    int64_t time_ns; // simulated time granted, since the scenario's epoch
    bool final;      // the last one: acknowledge it, then gs_next() returns false
} gs_tick;

// Called for each sample as it arrives, in the order of its writer; samples of different writers in any order. The
// sample is only valid during the call. source_ns: the simulated time at which it was sent.
typedef void gs_deliver(void* user, void const* sample, int64_t source_ns);

gs_member* gs_join(void);
void gs_reader(gs_member* m, char const* topic, dds_topic_descriptor_t const* type, gs_deliver* deliver, void* user);
gs_writer* gs_writer_of(gs_member* m, char const* topic, dds_topic_descriptor_t const* type);
void gs_start(gs_member* m);
bool gs_next(gs_member* m, gs_tick* tick);
// time_ns: the simulated time at which the sample takes effect. In real time it is ignored.
void gs_write(gs_member* m, gs_writer* writer, void const* sample, int64_t time_ns);
// The work of the tick is done. next_tick_needed: the first later tick in which this member wants to work even without
// input.
void gs_done(gs_member* m, gs_tick const* tick, uint64_t next_tick_needed);
void gs_leave(gs_member* m);

// "1/4" or "1" or "0.25" of an environment variable, in nanoseconds; ends the process when it is not there.
int64_t gs_environment_ns(char const* name);
