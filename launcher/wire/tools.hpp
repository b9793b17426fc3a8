// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/streams/stream.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The tools of `gridspace wire`. Each runs until its time is over or Ctrl-C, prints to stdout, and fails with what to
/// do.
namespace gridspace::wire {

/// A stream from the command line: an entry of a file's `streams:`, changed by KEY=VALUE, or KEY=VALUE alone.
struct StreamArgument {
    std::filesystem::path file; ///< scenario, or a file with `streams:`
    std::string name;           ///< in the file
    std::vector<std::string> keys;
};
/// Reads it with the rules of `streams:`; what is wrong is printed. Nothing then.
[[nodiscard]] std::optional<streams::Stream> read_stream(StreamArgument const& argument, streams::Kind kind);
/// Whether the user said it: a file says all keys of its stream, otherwise those that were written out.
[[nodiscard]] bool is_named(StreamArgument const& argument, std::string_view key);

struct ListOptions {
    std::string interface;
    double duration_s{0};
    bool json{false}, once{false}; ///< once: one table at the end, not one per second
};
[[nodiscard]] Result<void> list(ListOptions const& options);

struct SvPublishOptions {
    std::string interface;
    StreamArgument stream;
    std::string source; ///< MAC; empty: the interface's
    double duration_s{0}, amplitude{100}, frequency_hz{60};
    int streams{1};                 ///< more: APPID, last octet of the address and svID count up
    std::int64_t first_smp_cnt{-1}; ///< -1: by the time of day, 0 on the second
};
[[nodiscard]] Result<void> sv_publish(SvPublishOptions const& options);

struct SvSubscribeOptions {
    std::string interface;
    StreamArgument stream; ///< its data set decodes the samples; without any key all streams are taken, undecoded
    double duration_s{0};
    std::uint64_t count{0}; ///< end after so many frames
    bool frames{false};     ///< a line per frame, not per second
};
[[nodiscard]] Result<void> sv_subscribe(SvSubscribeOptions const& options);

struct GoosePublishOptions {
    std::string interface;
    StreamArgument stream;
    std::string source;
    std::vector<std::string> values; ///< leaf=value, initial
    double duration_s{0};
    double toggle_s{0}; ///< change the first boolean so often
    bool nds_com{false};
    std::uint32_t first_st_num{1};
    bool interactive{false}; ///< read leaf=value lines from stdin
};
[[nodiscard]] Result<void> goose_publish(GoosePublishOptions const& options);

struct GooseSubscribeOptions {
    std::string interface;
    StreamArgument stream; ///< without any key all messages are shown
    double duration_s{0};
    std::uint64_t count{0};
    bool strict{false};
};
[[nodiscard]] Result<void> goose_subscribe(GooseSubscribeOptions const& options);

/// Sending recorded frames is an attack on all that listen: only virtual cables, unless the user says which interface
/// he means.
[[nodiscard]] Result<void> check_attack_allowed(std::string const& interface, std::string const& allowed);

struct ReplayOptions {
    std::filesystem::path file;
    std::string interface;
    double speed{1}; ///< 0: as fast as possible
    int loops{1};
    std::string allow_attacks_on; ///< an interface that is not a virtual cable
    std::string only;             ///< of a capture of several interfaces: this one
    bool all_protocols{false};
};
[[nodiscard]] Result<void> replay(ReplayOptions const& options);

/// Reads "true", "-3", "1.5", "closed", "0x0800", "text" as a value of a leaf.
[[nodiscard]] Result<iec61850::Value> parse_value(iec61850::Leaf const& leaf, std::string const& text,
                                                  std::string& storage);

} // namespace gridspace::wire
