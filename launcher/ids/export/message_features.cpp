// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/message_features.hpp"

#include <algorithm>

namespace gridspace::dataset {

void MessageFeatures::take(Captured const& at, iec61850::GooseFrame const& message, FrameLabels::Label const& label,
                           CsvFile& out) {
    auto const of_last = [&](auto value) { return has_last_ ? fmt::format("{:.9g}", static_cast<double>(value)) : ""; };
    double const gap_ms = 1e-6 * static_cast<double>(at.unix_ns - last_ns_);
    double const age_ms = 1e-6 * static_cast<double>(at.unix_ns - message.t.nanoseconds());
    bool const changed =
        has_last_ && !std::equal(data_.begin(), data_.end(), message.all_data.begin(), message.all_data.end());
    out.row("{},{},{},{},{},{},{},{},{:.9g},{},{},{},{},{},{},{}", at.prefix, message.header.source.to_string(),
            cell(name_), message.st_num, message.sq_num, of_last(std::int64_t{message.st_num} - st_num_),
            of_last(std::int64_t{message.sq_num} - sq_num_), of_last(gap_ms), age_ms, message.live_ms, message.conf_rev,
            message.simulated() ? 1 : 0, message.entries, changed ? 1 : 0, label.altered() ? 1 : 0, label.attack);
    has_last_ = true;
    last_ns_ = at.unix_ns;
    st_num_ = message.st_num;
    sq_num_ = message.sq_num;
    data_.assign(message.all_data.begin(), message.all_data.end());
}

} // namespace gridspace::dataset
