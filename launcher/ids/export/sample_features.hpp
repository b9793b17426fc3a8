// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/sample_reader.hpp"
#include "launcher/ids/export/csv_file.hpp"
#include "launcher/ids/export/frame_labels.hpp"

#include <memory>

namespace gridspace::dataset {

/// Where and when a frame was captured, as the first cells of its rows.
struct Captured {
    std::uint64_t number{0}; ///< in the capture of its vantage point, from 1
    std::int64_t time_ns{0}; ///< since the start of the run
    std::int64_t unix_ns{0}; ///< by the capture's clock, which is finer in real time: for distances
    std::string const& interface;
    std::string prefix; ///< "12,0.000416667,process_bus/mu21"
};

/// The features of one stream of sampled values at one vantage point, from what came before: no sample is looked at
/// twice, and memory is a cycle.
class SampleFeatures {
  public:
    static constexpr char const* kColumns =
        "frame,time_s,port,source,stream,sample,smp_cnt,smp_synch,simulated,gap_us,count_step,ia_a,ib_a,ic_a,sum_a,"
        "kink_a_a,kink_b_a,kink_c_a,peak_a,altered,altered_phases,attack";

    /// Of a stream of the scenario.
    static SampleFeatures of(streams::Stream const& stream, double frequency_hz);

    /// An ASDU; writes its row, and returns its label. `whole`: of its frame.
    FrameLabels::Label take(Captured const& at, iec61850::FrameHeader const& header, iec61850::Asdu const& asdu,
                            FrameLabels const& labels, FrameLabels::Label const& whole, CsvFile& out);

  private:
    struct Accepted { ///< the sample of an index that came first
        std::int64_t index{0};
        relay::Abc currents_a{};
        double peak_a{0};
    };
    [[nodiscard]] Accepted const* accepted(std::int64_t index) const;

    std::string name_;
    double rate_hz_{4800};
    double turn_{0}; ///< 2 cos(w): of a sinusoid of the nominal frequency x[n] = turn x[n-1] - x[n-2]
    std::shared_ptr<relay::SampleReader const> reader_; ///< nothing: no three currents
    std::vector<Accepted> cycle_;                       ///< by index modulo its length
    std::int64_t newest_{-1}, last_index_{-1}, last_ns_{-1};
};

} // namespace gridspace::dataset
