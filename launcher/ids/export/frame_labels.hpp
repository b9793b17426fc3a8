// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/octets.hpp"
#include "launcher/ids/export/run_source.hpp"

#include <array>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gridspace::dataset {

/// Which of the frames of a capture somebody forged or altered, by the ground truth of the run.
class FrameLabels {
  public:
    /// `run` has to outlive it.
    explicit FrameLabels(RunSource const& run);

    struct Label {
        std::string_view attack; ///< empty: genuine
        std::uint8_t phases{0};  ///< bit 0: a; of samples
        [[nodiscard]] bool altered() const { return !attack.empty(); }
    };
    /// A sample that was captured with these currents: a phase is altered when it is labelled and what was captured is
    /// nearer to what was sent than to what is true. This separates a forged sample from the genuine one next to it.
    [[nodiscard]] Label of_sample(std::string const& stream, std::int64_t index,
                                  std::array<double, 3> const& currents_a) const;

    /// What a man in the middle does to messages and frames is found by comparison: all frames of a capture have to be
    /// shown once before the first question, where this says so.
    [[nodiscard]] bool has_to_learn() const { return !altered_on_the_way_.empty(); }
    void learn(std::string const& interface, double time_s, iec61850::Octets frame);
    /// A message: forged when it came from the port of an attacker whose target it is within the attack's time; altered
    /// when it left a cable with an attacker in it as no message had come into it.
    [[nodiscard]] Label of_message(std::string const& stream, std::string const& interface, double time_s,
                                   iec61850::Octets frame) const;
    /// A frame of sampled values whose attack leaves the currents alone: forged when it came from the port of an
    /// attacker; altered, a copy or late when it left a cable with an attacker in it as none had come into it, more
    /// often, or later. To be asked once for each frame, in the order of the capture.
    [[nodiscard]] Label of_frame(std::string const& stream, std::string const& interface, double time_s,
                                 iec61850::Octets frame);

  private:
    struct Place {
        std::string attack, stream;
        bool frames{false}; ///< of sampled values
        std::string port;   ///< "process_bus/evil"
        double from_s{0}, until_s{0};
    };
    struct CameIn {
        double time_s{0};
        bool went_on{false};
    };
    [[nodiscard]] Place const* from_beside(std::string const& stream, std::string const& interface, double time_s,
                                           bool frames) const;

    RunSource const& run_;
    std::vector<Place> beside_, altered_on_the_way_;
    /// By hash: what came in on the publisher's side of such an attacker, in the order of time.
    std::unordered_map<std::size_t, std::vector<CameIn>> came_in_;
};

} // namespace gridspace::dataset
