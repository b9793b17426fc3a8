/* SPDX-FileCopyrightText: 2026 Gridspace contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * libgridspace: an agent of a Gridspace run, in C or in any language that calls C. docs/reference/c_abi.md explains it.
 *
 * Stable: within one GRIDSPACE_ABI_VERSION functions and members of gridspace_program are only added, behind those that
 * are there. Symbols have the version GRIDSPACE_1.
 *
 * Threads: everything with a gridspace_agent is called from a callback, on the thread that called gridspace_main.
 * gridspace_keep, gridspace_release, gridspace_layout, gridspace_log and gridspace_last_error may be called from any.
 *
 * Ownership: texts and samples that the library gives are its own. A text of an agent is there until gridspace_main
 * returns, a sample until its callback returns, or longer with gridspace_keep. What is passed in is copied.
 *
 * Failure: functions that can fail return -1 (NULL where they return a pointer), and gridspace_last_error says why.
 */
#ifndef GRIDSPACE_AGENT_H
#define GRIDSPACE_AGENT_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GRIDSPACE_ABI_VERSION 1
#if defined(__GNUC__)
#define GRIDSPACE_API __attribute__((visibility("default")))
#else
#define GRIDSPACE_API
#endif

typedef struct gridspace_agent gridspace_agent; /* this process, on the bus */

/* What a program is and does. A callback that is NULL is not called; one that returns something else than 0 ends the
 * run, with what gridspace_fail was told, or with the last error. */
typedef struct gridspace_program {
    size_t size;             /* sizeof(gridspace_program) */
    char const* description; /* JSON: docs/reference/program_description.md */
    char const* folder;      /* where the files of `idl` in it are; NULL: the folder of argv[0] */
    void* user;              /* handed to the callbacks */
    /* Once, in the first tick: settings, readers and writers are there, and timers can be set. */
    int (*begin)(gridspace_agent* agent, void* user);
    /* A sample has come. Those of all readers, and the timers, come in the order of simulated time; a sample before a
     * timer of the same time. In lockstep that order is the same in every run. */
    int (*sample)(gridspace_agent* agent, int reader, void const* sample, size_t size, void* user);
    /* The time of a timer has come, and everything up to it has been handed over. */
    int (*due)(gridspace_agent* agent, int timer, void* user);
    /* There will be no more: the run has ended, or was asked to. Nothing can be written any more. */
    void (*end)(gridspace_agent* agent, void* user);
} gridspace_program;

/* The whole life of a program: options (--config FILE, --check, --describe, --log-level, --status-fd, --version),
 * start, tick after tick, end. In lockstep and in real time. Call it once, from main, before other threads are started:
 * it takes SIGINT and SIGTERM. Returns the exit code (docs/reference/exit_codes.md). */
GRIDSPACE_API int gridspace_main(gridspace_program const* program, int argc, char** argv);

GRIDSPACE_API unsigned gridspace_abi_version(void);
GRIDSPACE_API char const* gridspace_version(void); /* "0.1.0" */
/* Why the last call on this thread failed; valid until the next one that fails. */
GRIDSPACE_API char const* gridspace_last_error(void);

/* Simulated time of the callback: of its sample or timer, in nanoseconds and in seconds since simulated time 0. */
GRIDSPACE_API int64_t gridspace_now_ns(gridspace_agent const* agent);
GRIDSPACE_API double gridspace_now_s(gridspace_agent const* agent);
/* When what is written now takes effect: `latency` of the description later in lockstep, now in real time. */
GRIDSPACE_API int64_t gridspace_effect_ns(gridspace_agent const* agent);
GRIDSPACE_API int gridspace_is_lockstep(gridspace_agent const* agent);
GRIDSPACE_API char const* gridspace_process(gridspace_agent const* agent); /* its name in the scenario */

/* Timers; their number, or -1. `period_s` is a decimal number or a fraction, "360" or "1/4": the timer is due at its
 * whole multiples, from now on. Those that a paused or restarted process has missed are left out. */
GRIDSPACE_API int gridspace_every(gridspace_agent* agent, char const* period_s);
GRIDSPACE_API int gridspace_at(gridspace_agent* agent, int64_t time_ns);
GRIDSPACE_API int gridspace_cancel(gridspace_agent* agent, int timer);

/* A setting as text: "period_s", "limits.low". Defaults count. NULL: it is not given. */
GRIDSPACE_API char const* gridspace_setting(gridspace_agent const* agent, char const* path);
GRIDSPACE_API int gridspace_number(gridspace_agent const* agent, char const* path, double* value);
/* All of them as JSON, with defaults; a fraction is a text. */
GRIDSPACE_API char const* gridspace_settings(gridspace_agent const* agent);

/* Numbers of the topics that the description names; patterns in it have been filled in. */
GRIDSPACE_API int gridspace_reader(gridspace_agent const* agent, char const* topic);
GRIDSPACE_API int gridspace_writer(gridspace_agent const* agent, char const* topic);
/* {"reads": [{"topic", "declared", "type", "layout"}], "writes": [...],
 *  "signals": [{"name", "unit", "declared", "value"}]}, in the order of their numbers. `declared`: the name in the
 * description, `value`: what has been filled in. */
GRIDSPACE_API char const* gridspace_topics(gridspace_agent const* agent);

/* Sends a sample: a struct of the type's layout, `size` octets. Its member time_ns, where there is one, is set to
 * gridspace_effect_ns. Refused, with the member's name: what is not finite, too long, or no value of its enum. */
GRIDSPACE_API int gridspace_write(gridspace_agent* agent, int writer, void const* sample, size_t size);
/* A sample that a callback was given, for longer: until gridspace_release has been called as often. */
GRIDSPACE_API void gridspace_keep(void const* sample);
GRIDSPACE_API void gridspace_release(void const* sample);
/* How samples of a type lie in memory, as JSON. `idl_file`: the file that defines it; NULL for a type of Gridspace. The
 * text stays. */
GRIDSPACE_API char const* gridspace_layout(char const* type, char const* idl_file);

/* Signals of the description, by their number or name. All values of a callback become one row when it returns. */
GRIDSPACE_API int gridspace_signal(gridspace_agent* agent, int signal, double value);
GRIDSPACE_API int gridspace_signal_number(gridspace_agent const* agent, char const* name);
/* The number of what a name of the description has become, like "agent.{process}[.{evs}].v_pu", for a value of its
 * setting, like "EV1"; with NULL: the only one that it has become. */
GRIDSPACE_API int gridspace_declared_signal(gridspace_agent const* agent, char const* declared, char const* value);

enum { GRIDSPACE_DEBUG, GRIDSPACE_INFO, GRIDSPACE_WARNING, GRIDSPACE_ERROR };
GRIDSPACE_API void gridspace_log(int level, char const* text);
/* Ends the run for everybody, with exit code 4 and this message: `return gridspace_fail(agent, "...", NULL);`. Returns
 * -1. `remedy`: a line that helps, or NULL. */
GRIDSPACE_API int gridspace_fail(gridspace_agent* agent, char const* message, char const* remedy);

#ifdef __cplusplus
}
#endif
#endif
