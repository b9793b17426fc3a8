// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/random.hpp"
#include "gateways/bump_in_the_wire/frame_hook.hpp"
#include "gateways/iec61850/routable.hpp"
#include "gateways/iec61850/sv.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// What a bad cable does, all of the time. Times are simulated.
struct Impairments {
    bool up{true};                ///< false: nothing passes
    double loss_percent{0};       ///< share of the frames that are lost ...
    double loss_burst{1};         ///< ... so many in a row
    double to_bad_percent{0};     ///< Gilbert-Elliott: chance that a good line has turned bad, at each frame ...
    double to_good_percent{10};   ///< ... that a bad one has turned good ...
    double bad_loss_percent{100}; ///< ... and the share of the frames that a bad one loses
    double delay_us{0};
    double jitter_us{0}; ///< added to the delay, uniform from 0; the order stays
    double rate_mbps{0}; ///< bits of the line; 0: no limit
    double queue_ms{10}; ///< with a rate: what would have to wait for longer is lost
    double duplicate_percent{0};
    double duplicate_after_us{0};
    double reorder_percent{0}; ///< share of the frames that are overtaken ...
    double reorder_by{1};      ///< ... by so many later ones
    double corrupt_percent{0};
    double corrupt_bits{1}; ///< bits that are turned over, anywhere behind the ethertype
};

/// The numbers above by their names, for configuration and events. A flag counts as 0 or 1.
[[nodiscard]] bool set_impairment(Impairments& impairments, std::string_view key, double value);
/// Why a value cannot be; empty when it can. `key` must be known.
[[nodiscard]] std::string wrong_with_impairment(std::string_view key, double value);
[[nodiscard]] std::vector<std::string> impairment_keys();

/// How frames of a declared stream are recognised.
struct StreamMark {
    std::string name;
    std::uint16_t ethertype{0}, app_id{0};
    iec61850::Mac destination;
    double rate_hz{4800}; ///< SMV
};

/// Something that happens to single samples of an SMV stream, counted from simulated time 0.
struct SampleImpairment {
    std::size_t stream{0}; ///< index of the mark
    std::int64_t first{0}, count{1};
    enum class What { lose, delay, duplicate, corrupt } what{What::lose};
    double delay_us{0};
};

/// From `at_ns` on `key` has another value.
struct ImpairmentChange {
    std::int64_t at_ns{0};
    std::string key;
    double value{0};
};

struct ImpairmentPlan {
    Impairments first;
    std::vector<ImpairmentChange> changes; ///< in the order of time
    std::vector<StreamMark> marks;
    std::vector<std::size_t> only; ///< streams that are impaired; empty: all frames
    std::vector<SampleImpairment> samples;
};

/// The hook that does it. The same seed, frames and times give the same outcome; each kind of damage draws from random
/// numbers of its own, so that changing one leaves the others alone. No allocation per frame after the longest one.
class Impairment final : public FrameHook {
  public:
    Impairment(ImpairmentPlan plan, std::uint64_t seed, std::string_view name);

    void pass(PassingFrame const& frame, FrameOutput& out) override;
    [[nodiscard]] std::optional<std::int64_t> due() const override;
    void elapse(std::int64_t now_ns, FrameOutput& out) override;

    /// May be read from another thread.
    struct Counters {
        std::atomic<std::uint64_t> seen{0}, lost{0}, delayed{0}, duplicated{0}, reordered{0}, corrupted{0};
    };
    [[nodiscard]] Counters const& counters() const { return counters_; }

  private:
    static constexpr std::int64_t kLongestHoldNs = 100'000'000; ///< for a frame to be overtaken

    void apply_changes(std::int64_t now_ns);
    [[nodiscard]] iec61850::Octets message_of(iec61850::Octets frame);
    [[nodiscard]] std::optional<std::size_t> stream_of(std::span<std::uint8_t const> octets);
    [[nodiscard]] SampleImpairment const* impairment_of(std::size_t stream, PassingFrame const& frame);
    [[nodiscard]] bool is_lost();
    [[nodiscard]] std::span<std::uint8_t const> corrupted(std::span<std::uint8_t const> octets);
    /// When the frame leaves, as a delay; negative: the queue is full.
    [[nodiscard]] std::int64_t departure(std::int64_t now_ns, std::size_t octets, double extra_us);

    ImpairmentPlan plan_;
    Impairments now_;
    std::size_t next_change_{0};
    Random loss_, line_, jitter_, duplication_, reordering_, corruption_;
    bool bad_{false};              ///< the state of the line
    std::int64_t losing_{0};       ///< frames of the present burst that are still to be lost
    std::int64_t last_out_ns_{0};  ///< of the newest frame: later ones do not overtake it
    std::int64_t line_free_ns_{0}; ///< with a rate
    std::vector<std::uint8_t> held_, damaged_;
    std::int64_t held_for_{0}, held_since_ns_{0}; ///< frames that have yet to overtake the held one; 0: none is held
    iec61850::SvFrame decoded_;
    iec61850::RoutableFrame session_;
    std::vector<std::uint8_t> message_; ///< out of a datagram
    Counters counters_;
};

} // namespace gridspace::gateways
