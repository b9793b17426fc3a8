// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// What is fuzzed, each as a function of any octets. The same functions replay the kept corpus in the ordinary tests
/// (replay_test.cpp) and are targets of libFuzzer in the preset `asan` (fuzzer_main.cpp). A new one: a line here, a
/// function, and a folder of its name in corpus/.
// clang-format off
#define GRIDSPACE_FUZZ_TARGETS_OF_DEVICES(X)                                                       \
    X(sv)      /* a frame: decoded, re-encoded, decoded again */                                    \
    X(goose)   /* a frame: decoded, given to a subscriber */                                        \
    X(routable) /* a datagram of R-GOOSE or R-SV: decoded, encoded, decoded again */                \
    X(prp)     /* a frame with the trailer of redundant networks: read, written, read again */      \
    X(ptp)     /* what a PTP daemon answers; the state of a clock */                                \
    X(ber)     /* allData: walked and read as every type */                                         \
    X(pcapng)  /* a capture file */                                                                 \
    X(streams) /* a `streams:` map as YAML text */                                                  \
    X(scl)     /* an SCL file: imported, read as streams, and exported */                           \
    X(mapping) /* the table of a gateway as YAML text, applied when it is valid */                  \
    X(yaml)    /* a configuration: parsed, merged with itself, printed, read back to the same tree */ \
    X(idl)     /* a type description, then (after a NUL) a sample */                                \
    X(mcap)    /* a recording */                                                                    \
    X(rtps)    /* a datagram for DDS: judged, and what is admitted judged again */               \
    X(sample)  /* a sample of each type of ours: decoded, encoded, decoded again */

#ifdef GRIDSPACE_DEVICES_ONLY
#define GRIDSPACE_FUZZ_TARGETS(X) GRIDSPACE_FUZZ_TARGETS_OF_DEVICES(X)
#else
#define GRIDSPACE_FUZZ_TARGETS(X)                                                                  \
    GRIDSPACE_FUZZ_TARGETS_OF_DEVICES(X)                                                           \
    X(fmu)         /* an FMU: its table of contents, its files, its description (also as XML alone) */ \
    X(matlab_case) /* a MATPOWER case */                                                            \
    X(dss)         /* an OpenDSS script (and, after NULs, files it may redirect to), built and solved */ \
    X(network)     /* a network file, checked */                                                    \
    X(scenario)    /* a scenario file, checked as `validate` does */                                \
    X(router)      /* a router's file */                                                            \
    X(model)       /* a model of a detector, written and read again */                              \
    X(columns)     /* a profile (CSV), currents for a detector (CSV, npy), its verdicts (CSV) */    \
    X(graph)       /* graph.json of a run: read, drawn, written, read again */                      \
    X(run_folder)  /* manifest.json, summary.json and events.ndjson of a run: shown and judged */   \
    X(http)        /* what a client sends to the monitor */                                         \
    X(websocket)   /* what it sends behind a valid upgrade to a WebSocket */
#endif
// clang-format on

namespace gridspace::fuzz {

#define GRIDSPACE_DECLARE(name) void name(std::uint8_t const* data, std::size_t size);
GRIDSPACE_FUZZ_TARGETS(GRIDSPACE_DECLARE)
#undef GRIDSPACE_DECLARE

struct Target {
    char const* name;
    void (*run)(std::uint8_t const*, std::size_t);
};
#define GRIDSPACE_LIST(name) {#name, name},
inline constexpr Target kTargets[] = {GRIDSPACE_FUZZ_TARGETS(GRIDSPACE_LIST)};
#undef GRIDSPACE_LIST

/// Ends the program with a message when `ok` is false, also in a build without assertions.
void require(bool ok, char const* what);

} // namespace gridspace::fuzz
