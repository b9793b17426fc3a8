// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/sample_reader.hpp"
#include "common/result.hpp"
#include "gateways/first_line/first_line.hpp"
#include "gateways/iec61850/stream_alignment.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/streams/stream.hpp"

#include <array>
#include <functional>
#include <optional>

namespace gridspace::relay {

/// Two streams of sampled values in, time-aligned pairs out. Pure: frames and times are given to it.
class CurrentInputs {
  public:
    using Members = PhaseMembers;
    struct Params {
        std::array<Members, 2> members;
        std::int64_t partner_timeout_ns{20'000'000};
        int max_interpolated{
            3}; ///< what the relay bridges: for more in a row that may be late only, it waits two frames
        gateways::FirstLineConfig first_line;
        bool accept_test{false};   ///< simulated frames are taken, and nothing suspicious
        bool judge_arrival{false}; ///< real time: when a frame came says something
        double speed{1};           ///< real time: of the simulation clock
    };
    [[nodiscard]] static Result<CurrentInputs> create(streams::Stream const& from, streams::Stream const& to,
                                                      Params const& params);

    using OnPair = std::function<void(LineSample const&)>;
    /// What the first-line rules found in a frame of end 0 or 1.
    using OnFinding = std::function<void(std::size_t end, std::uint32_t findings, iec61850::Mac const& source)>;
    void on_finding(OnFinding on_finding) { on_finding_ = std::move(on_finding); }
    /// Nothing came of end 0 or 1 for longer than the partner timeout.
    using OnSilence = std::function<void(std::size_t end)>;
    void on_silence(OnSilence on_silence) { on_silence_ = std::move(on_silence); }
    /// The stream of end 0 or 1 is not the one that is subscribed to any more: another confRev or size of its samples
    /// (`why`, and what the frame said). Once, until a second of it was taken again.
    using OnRefusal = std::function<void(std::size_t end, iec61850::SvEvent why, iec61850::Asdu const& asdu)>;
    void on_refusal(OnRefusal on_refusal) { on_refusal_ = std::move(on_refusal); }
    /// A frame of sampled values, which came at `arrival_ns`. Pairs that are complete now are given out.
    void frame(iec61850::Octets octets, std::int64_t arrival_ns, OnPair const& on_pair);
    /// When time alone gives something out, or a stream falls silent.
    [[nodiscard]] std::optional<std::int64_t> deadline() const;
    void elapse(std::int64_t now_ns, OnPair const& on_pair);

    struct End {
        iec61850::SvSubscriber subscriber;
        SampleReader reader;
        gateways::SvFirstLine first_line;
        std::int64_t taken_since_refusal{-1}; ///< samples; below 0: no refusal was told
        bool contest_next{false}; ///< a contested sample had been given out already: its successor answers for it
    };
    [[nodiscard]] End const& end(std::size_t i) const { return ends_[i]; }
    [[nodiscard]] iec61850::DecodeCounters const& damaged() const { return damaged_; }

  private:
    CurrentInputs(std::vector<End> ends, std::int64_t timeout_ns, std::uint32_t wrap, std::int64_t held_back,
                  iec61850::StreamAlignment<EndSample>::Overtaking overtaking)
        : ends_{std::move(ends)}, alignment_{timeout_ns, wrap, held_back, overtaking} {}
    [[nodiscard]] bool pass_first_line(std::size_t end, iec61850::Asdu const& asdu, std::size_t place,
                                       std::int64_t arrival_ns);
    void give_out(std::int64_t now_ns, OnPair const& on_pair);
    void tell_refusal(std::size_t end, iec61850::SvArrival const& arrival, iec61850::Asdu const& asdu);

    std::vector<End> ends_; ///< from, to
    bool same_sv_id_{false};
    iec61850::StreamAlignment<EndSample> alignment_;
    iec61850::SvFrame decoded_;
    iec61850::DecodeCounters damaged_;
    OnFinding on_finding_;
    OnSilence on_silence_;
    OnRefusal on_refusal_;
};

} // namespace gridspace::relay
