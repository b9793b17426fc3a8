// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sv_template.hpp"

#include "gateways/iec61850/ber.hpp"
#include "gateways/iec61850/encode_error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

/// Octets of the fields of an ASDU.
std::size_t content_octets(AsduDescription const& a) {
    return element_octets(a.sv_id.size()) + (a.dat_set.empty() ? 0 : element_octets(a.dat_set.size())) + 4 + 6 +
           (a.refr_tm ? 10 : 0) + 3 + (a.smp_rate ? 4 : 0) + element_octets(a.sample_octets) + (a.smp_mod ? 4 : 0) +
           (a.gm_identity ? 10 : 0);
}

Result<void> check(std::vector<AsduDescription> const& asdus) {
    if (asdus.empty() || asdus.size() > SvTemplate::kMaxAsdusSent) {
        return unencodable(fmt::format("an SV frame of {} ASDUs", asdus.size()),
                           fmt::format("1 to {}", SvTemplate::kMaxAsdusSent));
    }
    for (AsduDescription const& asdu : asdus) {
        if (auto ok = check_visible("svID", asdu.sv_id, SvTemplate::kMaxSvId); !ok) {
            return ok;
        }
        if (!asdu.dat_set.empty()) {
            if (auto ok = check_visible("datSet", asdu.dat_set, SvTemplate::kMaxSvId); !ok) {
                return ok;
            }
        }
        if (asdu.sample_octets == 0) {
            return unencodable(fmt::format("the data set of '{}' is empty", asdu.sv_id));
        }
    }
    return {};
}

} // namespace

SvTemplate::Slot SvTemplate::append_asdu(AsduDescription const& asdu, std::size_t start, BerWriter& w) {
    auto const here = [&] { return static_cast<std::uint32_t>(start + w.size()); };
    Slot slot;
    w.head(0x30, content_octets(asdu));
    w.element(0x80, octets_of(asdu.sv_id));
    if (!asdu.dat_set.empty()) {
        w.element(0x81, octets_of(asdu.dat_set));
    }
    w.head(0x82, 2);
    slot.smp_cnt = here();
    w.integer(0, 2);
    w.head(0x83, 4);
    slot.conf_rev = here();
    w.integer(asdu.conf_rev, 4);
    if (asdu.refr_tm) {
        w.head(0x84, 8);
        slot.refr_tm = here();
        w.integer(0, 8);
    }
    w.head(0x85, 1);
    slot.smp_synch = here();
    w.integer(asdu.smp_synch, 1);
    if (asdu.smp_rate) {
        w.head(0x86, 2);
        w.integer(*asdu.smp_rate, 2);
    }
    w.head(0x87, asdu.sample_octets);
    slot.sample = here();
    slot.sample_octets = static_cast<std::uint32_t>(asdu.sample_octets);
    w.integer(0, asdu.sample_octets);
    if (asdu.smp_mod) {
        w.head(0x88, 2);
        w.integer(static_cast<std::uint16_t>(*asdu.smp_mod), 2);
    }
    if (asdu.gm_identity) {
        w.head(0x89, 8);
        w.integer(*asdu.gm_identity, 8);
    }
    return slot;
}

Result<SvTemplate> SvTemplate::create(Address const& address, std::vector<AsduDescription> const& asdus) {
    if (auto ok = check(asdus); !ok) {
        return std::unexpected{ok.error()};
    }
    std::size_t sequence = 0;
    for (AsduDescription const& asdu : asdus) {
        sequence += element_octets(content_octets(asdu));
    }
    std::size_t const pdu = 3 + element_octets(sequence);
    std::size_t const length = kHeaderOctets + element_octets(pdu);
    if (length > kMaxLength) {
        return unencodable(
            fmt::format("the SV frame of '{}' would have {} octets behind the ethertype", asdus.front().sv_id, length),
            fmt::format("Ethernet carries {}: fewer samples per frame or a smaller data set", kMaxLength));
    }
    SvTemplate out;
    append_header(out.frame_, address, kSvEthertype);
    std::size_t const app_id = app_id_offset(address);
    out.reserved1_ = app_id + 4;
    out.frame_.resize(app_id + length);
    store_be(out.frame_.data() + app_id + 2, static_cast<std::uint16_t>(length));

    std::size_t const start = app_id + kHeaderOctets;
    BerWriter w{std::span{out.frame_}.subspan(start)};
    w.head(0x60, pdu);
    w.head(0x80, 1);
    w.integer(asdus.size(), 1);
    w.head(0xA2, sequence);
    for (AsduDescription const& asdu : asdus) {
        out.slots_.push_back(append_asdu(asdu, start, w));
    }
    assert(w.ok() && start + w.size() == out.frame_.size());
    return out;
}

void SvTemplate::set_source(Mac const& source) noexcept {
    std::copy(source.octets.begin(), source.octets.end(), frame_.begin() + 6);
}

void SvTemplate::set_simulated(bool simulated) noexcept {
    patch(reserved1_, std::uint16_t{simulated ? kSimulatedBit : std::uint16_t{0}});
}

} // namespace gridspace::iec61850
