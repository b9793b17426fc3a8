// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/relay_events.hpp"
#include "agents/relay/functions/frequency_estimator.hpp"
#include "agents/relay/functions/function_set.hpp"
#include "agents/relay/functions/phasor_estimator.hpp"
#include "agents/relay/functions/polarising_memory.hpp"

#include <array>
#include <optional>

namespace gridspace::relay {

struct BayParams {
    double rate_hz{4800}, frequency_hz{60};
    int samples_per_cycle{80};
    double offset_cycles{2}; ///< time constant of the current's offset that is taken out; 0: none is
    double minimum_v{0};     ///< positive sequence below which neither frequency nor direction is measured
    double hold_s{1};        ///< of the polarising voltage after a collapse
    bool reversed{false};    ///< currents are counted out of what is protected
    bool seal_in{true};      ///< the trip stays until reset() or a reclosing
    int max_interpolated{3}; ///< samples missing in a row that are bridged by a straight line
    std::uint8_t inputs{0};  ///< of Quantity: kCurrents, kVoltages, kBusVoltages
    std::size_t event_capacity{256};
};

/// What came of one instant; none: missing, or not to be used.
struct BaySample {
    std::int64_t index{0};
    std::optional<Abc> i_a, v_v, bus_v;
};

/// Something that a function did.
struct FunctionEvent {
    enum class Kind : std::uint8_t { start, operate, reset, block, unblock, pickup, dropout, trip, release };
    std::int64_t index{0};
    Kind kind{Kind::start};
    std::size_t function{0}; ///< of start to unblock
    std::uint8_t phases{0};
    Abc i_a{}, v_v{}; ///< magnitudes
};
[[nodiscard]] std::string_view name_of(FunctionEvent::Kind kind);

/// The relay of a bay: samples in, phasors and frequency, functions, a trip out. No clock, no I/O, no allocation per
/// sample.
///
/// While no more than `max_interpolated` samples are missing in a row, what was measured last holds, and the gap is
/// bridged when the next sample comes. After a longer one what is missing is not available, and functions that need it
/// rest, until its window is full again.
class BayRelay {
  public:
    BayRelay(BayParams const& params, FunctionSet functions);

    /// Takes the samples of one instant. Indices rise; one that is not newer is ignored.
    void step(BaySample const& sample);
    /// Nothing comes any more: of Quantity.
    void lost(std::uint8_t inputs);
    /// Takes the seal off; false while a function still operates.
    bool reset();

    [[nodiscard]] bool pickup() const { return functions_.picks_up(); }
    [[nodiscard]] bool trip() const { return trip_; }
    /// A function, or all of them, cannot decide.
    [[nodiscard]] bool blocked() const { return blocked_; }
    [[nodiscard]] std::int64_t index() const { return index_; }
    [[nodiscard]] FunctionSet const& functions() const { return functions_; }
    [[nodiscard]] Measurement const& measured() const { return measured_; }
    [[nodiscard]] BoundedLog<FunctionEvent>& events() { return events_; }
    /// Rises whenever a state has changed.
    [[nodiscard]] std::uint64_t changes() const { return changes_; }

  private:
    /// One of the three inputs.
    struct Input {
        PhasorEstimator estimator;
        Abc last{};
        std::int64_t last_index{0};
        bool has_last{false};
    };
    void take(Input& input, std::optional<Abc> const& value, std::int64_t index);
    void push(Input& input, Abc const& value);
    [[nodiscard]] bool is_waiting(Input const& input, std::int64_t index) const;
    void follow_frequency();
    void follow_voltage();
    void measure();
    void measure_voltages();
    void decide();
    void note(FunctionEvent::Kind kind, std::size_t function = 0, std::uint8_t phases = 0);

    BayParams params_;
    FunctionSet functions_;
    std::array<Input, 3> inputs_; ///< currents, voltages, bus voltages
    FrequencyEstimator frequency_;
    PolarisingMemory memory_;
    Phasors voltage_{}; ///< of the newest sample
    Sequence voltage_sequence_;
    double relative_{0}; ///< frequency by which phasors are formed
    Complex turn_, turn_two_cycles_;
    Measurement measured_;
    std::vector<FunctionState> before_;
    std::vector<bool> blocked_before_;
    BoundedLog<FunctionEvent> events_;
    std::int64_t index_{0};
    std::uint64_t changes_{0};
    bool started_{false}, trip_{false}, picked_up_{false}, blocked_{true};
};

} // namespace gridspace::relay
