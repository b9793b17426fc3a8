// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
#include "common/program/declaration.hpp"
#include "sdk/gridspace/agent.h"
#include "sdk/sample_inbox.hpp"
#include "sdk/stream_ends.hpp"
#include "sdk/timers.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sdk {

/// What a program of C has said of itself, read.
struct DescribedProgram {
    program::Declaration declaration;
    std::filesystem::path folder; ///< of its IDL files
    gridspace_program callbacks{};
};

/// A program of C as a member of the run: opens what its description names, and calls it with samples and timers in the
/// order of simulated time. What it writes takes effect its latency after the sample or timer that it was called for.
class AgentMember : public bus::Member {
  public:
    /// `wire`: its port and its streams, when its description names any.
    AgentMember(DescribedProgram const& program, config::Node settings, gateways::WireConfig const& wire,
                bus::Node& node);
    ~AgentMember() override;

    [[nodiscard]] Result<void> prepare() override;
    void begin(bus::Tick const& tick) override;
    [[nodiscard]] Result<void> work(bus::Tick const& tick) override;
    [[nodiscard]] std::uint64_t next_tick(bus::Tick const& tick) const override;
    [[nodiscard]] std::optional<std::chrono::steady_clock::time_point> deadline() const override;
    void end(bus::Tick const& last) override;

    [[nodiscard]] bus::Node const& node() const { return node_; }
    [[nodiscard]] config::Node const& settings() const { return settings_; } ///< with defaults
    [[nodiscard]] std::string const& settings_json() const { return settings_json_; }
    [[nodiscard]] std::string const& topics_json() const { return topics_json_; }
    /// A scalar setting by its path, nullptr when it is not given.
    [[nodiscard]] std::string const* setting(std::string_view path) const;

    [[nodiscard]] SimTime now() const { return now_; } ///< of the sample or timer that the program was called for
    [[nodiscard]] SimTime effect_time() const { return node_.effect_time(now_, latency_); }
    [[nodiscard]] Result<int> every(std::string_view period_s);
    [[nodiscard]] Result<int> at(std::int64_t time_ns);
    [[nodiscard]] Result<void> cancel(int timer);

    /// Numbers by name, or by the pattern of the description (its first); nothing when that does not have it.
    [[nodiscard]] std::optional<int> reader(std::string_view topic) const;
    [[nodiscard]] std::optional<int> writer(std::string_view topic) const;
    [[nodiscard]] std::optional<int> signal_number(std::string_view name) const;
    /// What a name of the description became for a value of its placeholder; without one: the only one.
    [[nodiscard]] Result<int> declared_signal(std::string_view declared, std::optional<std::string_view> value) const;
    [[nodiscard]] Result<void> write(int writer, void const* sample, std::size_t size);
    [[nodiscard]] Result<void> signal(int number, double value);
    void fail_with(Error error); ///< what run_member returns when the callback has
    /// What its callback `end` has failed with.
    [[nodiscard]] Result<void> outcome() const { return failure_ ? std::unexpected{*failure_} : Result<void>{}; }
    /// The last error given to the program: the message of a callback that fails without one.
    void refused(std::string why) { refused_ = std::move(why); }

  private:
    struct Reader {
        std::string declared, topic; ///< with and without its pattern
        std::shared_ptr<TopicType const> type;
        std::shared_ptr<SampleInbox> inbox; ///< null: a stream
    };
    struct Writer {
        std::string declared, topic;
        std::shared_ptr<TopicType const> type;
        std::unique_ptr<bus::CdrWriter> cdr; ///< null: a stream
        std::size_t stream{0};
    };
    [[nodiscard]] Result<void> open_reads(program::Values const& values);
    [[nodiscard]] Result<void> open_writes(program::Values const& values);
    [[nodiscard]] Result<void> open_streams(program::Values const& values);
    [[nodiscard]] Result<void> open_signals(program::Values const& values);
    void describe_topics();
    [[nodiscard]] Result<void> hand_over(bus::Tick const& tick);
    void goes_on_to(SimTime now);
    /// After a callback: its row of signals, its failure.
    [[nodiscard]] Result<void> returned(int code, std::string_view callback);

    DescribedProgram const& program_;
    gateways::WireConfig const& wire_;
    config::Node settings_;
    std::string settings_json_, topics_json_;
    mutable std::map<std::string, std::string, std::less<>> asked_; ///< settings as texts that stay
    bus::Node& node_;
    SimSpan latency_;
    bus::TickGrid grid_;
    std::vector<Reader> readers_;
    std::vector<Writer> writers_;
    std::unique_ptr<StreamEnds> streams_; ///< may be null
    std::vector<bus::SignalColumn> columns_;
    struct Origin {
        std::string declared, value; ///< the name in the description; of its placeholder
    };
    std::vector<Origin> origins_; ///< of the columns
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<double> row_;
    bool row_is_new_{false}, begins_{false};
    bool works_in_every_tick_{false}; ///< a sample of the simulator is to be answered at once
    Timers timers_;
    SimTime now_;
    std::vector<SampleInbox::Arrival> arrivals_; ///< of a tick; reused
    std::vector<std::byte> cdr_, sample_;        ///< of a write; reused
    Result<void> begun_;
    std::optional<Error> failure_;
    std::string refused_;
};

} // namespace gridspace::sdk

/// The handle of the C interface.
struct gridspace_agent final : gridspace::sdk::AgentMember { // NOLINT(readability-identifier-naming): a name of C
    using AgentMember::AgentMember;
};
