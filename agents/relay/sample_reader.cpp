// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/sample_reader.hpp"

#include "gateways/iec61850/quality.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::relay {
namespace {

Synch synch_of(std::uint8_t smp_synch) {
    return smp_synch == iec61850::kNotSynchronised ? Synch::none
           : smp_synch == iec61850::kGlobalClock   ? Synch::global
                                                   : Synch::local;
}

} // namespace

Result<SampleReader> SampleReader::create(streams::Stream const& stream, PhaseMembers const& members) {
    SampleReader out{stream.data_set};
    auto const currents = out.find(stream.name.name, members.currents, 1e-3);
    auto const voltages = out.find(stream.name.name, members.voltages, 1e-2);
    if (!currents || !voltages) {
        return std::unexpected{!currents ? currents.error() : voltages.error()};
    }
    out.currents_ = *currents;
    out.voltages_ = *voltages;
    return out;
}

Result<std::optional<SampleReader::Phases>> SampleReader::find(std::string const& stream,
                                                               std::optional<std::array<std::string, 3>> const& members,
                                                               double of_integers) const {
    if (!members) {
        return std::optional<Phases>{};
    }
    Phases out;
    auto const& slots = layout_.slots();
    for (std::size_t phase = 0; phase < 3; ++phase) {
        auto const slot = layout_.index_of((*members)[phase]);
        if (!slot || !iec61850::is_number(slots[*slot].leaf.type)) {
            return fail(ExitCode::usage, fmt::format("stream '{}' has no number '{}'", stream, (*members)[phase]));
        }
        out.value[phase] = *slot;
        out.scale = iec61850::is_integer(slots[*slot].leaf.type) ? of_integers : 1.0;
        if (*slot + 1 < slots.size() && slots[*slot + 1].leaf.type == iec61850::BasicType::quality) {
            out.quality[phase] = *slot + 1;
        }
    }
    return std::optional{out};
}

EndSample SampleReader::read(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu) const {
    EndSample sample;
    sample.present = true;
    sample.synch = synch_of(asdu.smp_synch);
    sample.simulated = header.simulated();
    if (currents_) {
        read_phases(*currents_, asdu.sample, sample.i_a, sample);
    }
    if (voltages_) {
        read_phases(*voltages_, asdu.sample, sample.v_v, sample);
    }
    return sample;
}

void SampleReader::read_phases(Phases const& from, iec61850::Octets octets, Abc& values, EndSample& sample) const {
    for (std::size_t phase = 0; phase < 3; ++phase) {
        values[phase] = layout_.read(from.value[phase], octets).number() * from.scale;
        if (from.quality[phase]) {
            auto const q = static_cast<std::uint32_t>(layout_.read(*from.quality[phase], octets).bits);
            using iec61850::quality::Worth;
            if (Worth const worth = iec61850::quality::worth(q); worth != Worth::good) {
                sample.validity = std::max(sample.validity,
                                           worth == Worth::questionable ? Validity::questionable : Validity::invalid);
            }
            sample.test = sample.test || (q & iec61850::quality::kTest) != 0;
        }
    }
}

} // namespace gridspace::relay
