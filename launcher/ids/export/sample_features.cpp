// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/sample_features.hpp"

#include "agents/attacker/sv_forger.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::dataset {
namespace {

std::string phases_text(std::uint8_t phases) {
    std::string out;
    for (std::size_t phase = 0; phase < 3; ++phase) {
        if ((phases >> phase & 1U) != 0) {
            out += "abc"[phase];
        }
    }
    return out;
}

std::string number_text(bool is_known, double value) {
    return is_known ? fmt::format("{:.9g}", value) : std::string{};
}

} // namespace

SampleFeatures SampleFeatures::of(streams::Stream const& stream, double frequency_hz) {
    SampleFeatures out;
    out.name_ = stream.name.name;
    out.rate_hz_ = stream.rate_hz.to_double();
    out.turn_ = 2 * std::cos(2 * std::numbers::pi * frequency_hz / out.rate_hz_);
    auto const cycle = static_cast<std::size_t>(std::max(3L, std::lround(out.rate_hz_ / frequency_hz)));
    out.cycle_.assign(cycle, {-1, {}, 0});
    std::vector<std::string> const phases = attacker::phase_channels(stream);
    if (phases.size() == 3) {
        relay::PhaseMembers members;
        members.currents = std::array{phases[0], phases[1], phases[2]};
        if (auto reader = relay::SampleReader::create(stream, members)) {
            out.reader_ = std::make_shared<relay::SampleReader const>(std::move(*reader));
        }
    }
    return out;
}

SampleFeatures::Accepted const* SampleFeatures::accepted(std::int64_t index) const {
    Accepted const& at = cycle_[static_cast<std::size_t>(std::max<std::int64_t>(index, 0)) % cycle_.size()];
    return index >= 0 && at.index == index ? &at : nullptr;
}

FrameLabels::Label SampleFeatures::take(Captured const& at, iec61850::FrameHeader const& header,
                                        iec61850::Asdu const& asdu, FrameLabels const& labels,
                                        FrameLabels::Label const& whole, CsvFile& out) {
    double const time_s = 1e-9 * static_cast<double>(at.time_ns);
    auto const second = std::llround(time_s - asdu.smp_cnt / rate_hz_);
    std::int64_t const index = std::llround(static_cast<double>(second) * rate_hz_) + asdu.smp_cnt;
    bool const has_currents = reader_ && asdu.sample.size() == reader_->sample_octets();
    relay::Abc const i = has_currents ? reader_->read(header, asdu).i_a : relay::Abc{};
    FrameLabels::Label const of_currents = has_currents ? labels.of_sample(name_, index, i) : FrameLabels::Label{};
    FrameLabels::Label const& label = of_currents.altered() ? of_currents : whole;

    Accepted const *const one = accepted(index - 1), *const two = accepted(index - 2);
    bool const has_kink = has_currents && one != nullptr && two != nullptr;
    relay::Abc kink{};
    for (std::size_t phase = 0; has_kink && phase < 3; ++phase) {
        kink[phase] = i[phase] - turn_ * one->currents_a[phase] + two->currents_a[phase];
    }
    double peak = 0;
    for (Accepted const& old : cycle_) {
        if (old.index >= 0 && old.index < index && old.index + static_cast<std::int64_t>(cycle_.size()) >= index) {
            peak = std::max(peak, old.peak_a);
        }
    }
    out.row("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", at.prefix, header.source.to_string(), name_,
            index, asdu.smp_cnt, asdu.smp_synch, header.simulated() ? 1 : 0,
            number_text(last_ns_ >= 0, 1e-3 * static_cast<double>(at.unix_ns - last_ns_)),
            last_index_ >= 0 ? fmt::format("{}", index - last_index_) : std::string{}, number_text(has_currents, i[0]),
            number_text(has_currents, i[1]), number_text(has_currents, i[2]),
            number_text(has_currents, i[0] + i[1] + i[2]), number_text(has_kink, kink[0]),
            number_text(has_kink, kink[1]), number_text(has_kink, kink[2]), number_text(has_currents, peak),
            label.altered() ? 1 : 0, phases_text(label.phases), label.attack);
    last_ns_ = at.unix_ns;
    last_index_ = index;
    if (has_currents && index > newest_) {
        newest_ = index;
        cycle_[static_cast<std::size_t>(index) % cycle_.size()] = {
            index, i, std::max({std::fabs(i[0]), std::fabs(i[1]), std::fabs(i[2])})};
    }
    return label;
}

} // namespace gridspace::dataset
