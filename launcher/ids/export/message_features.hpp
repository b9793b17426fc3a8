// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose.hpp"
#include "launcher/ids/export/sample_features.hpp"

namespace gridspace::dataset {

/// The features of one GOOSE stream at one vantage point, each against the message before it.
class MessageFeatures {
  public:
    static constexpr char const* kColumns = "frame,time_s,port,source,stream,st_num,sq_num,st_step,sq_step,gap_ms,age_"
                                            "ms,live_ms,conf_rev,simulated,entries,"
                                            "data_changed,altered,attack";

    explicit MessageFeatures(std::string name) : name_{std::move(name)} {}

    /// A message; writes its row.
    void take(Captured const& at, iec61850::GooseFrame const& message, FrameLabels::Label const& label, CsvFile& out);

  private:
    std::string name_;
    bool has_last_{false};
    std::int64_t last_ns_{0}, st_num_{0}, sq_num_{0};
    std::vector<std::uint8_t> data_;
};

} // namespace gridspace::dataset
