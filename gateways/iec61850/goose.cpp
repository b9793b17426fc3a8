// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/goose.hpp"

#include "gateways/iec61850/mms_data.hpp"

namespace gridspace::iec61850 {
namespace {

constexpr std::uint32_t kGoosePdu = 0x61, kFirstGooseField = 0x80, kLastPrimitive = 0x8A, kAllData = 0xAB,
                        kGooseSecurity = 0xAC;
constexpr std::uint16_t kMandatoryGooseFields =
    GooseFrame::gocb_ref_field | GooseFrame::live_field | GooseFrame::dat_set_field | GooseFrame::t_field |
    GooseFrame::st_num_field | GooseFrame::sq_num_field | GooseFrame::conf_rev_field | GooseFrame::entries_field |
    GooseFrame::all_data_field;

Reason read_flag(Octets value, bool& out) noexcept {
    if (value.size() != 1) {
        return Reason::bad_value;
    }
    out = value[0] != 0;
    return Reason::none;
}

Reason read_field(Tlv const& field, GooseFrame& out) noexcept {
    switch (field.tag) {
    case 0x80:
        out.gocb_ref = text_of(field.value);
        return Reason::none;
    case 0x81:
        return read_unsigned(field.value, out.live_ms);
    case 0x82:
        out.dat_set = text_of(field.value);
        return Reason::none;
    case 0x83:
        out.go_id = text_of(field.value);
        return Reason::none;
    case 0x84:
        if (field.value.size() != 8) {
            return Reason::bad_value;
        }
        out.t = UtcTime::from_bits(load_be<std::uint64_t>(field.value.data()));
        return Reason::none;
    case 0x85:
        return read_unsigned(field.value, out.st_num);
    case 0x86:
        return read_unsigned(field.value, out.sq_num);
    case 0x87:
        return read_flag(field.value, out.simulation);
    case 0x88:
        return read_unsigned(field.value, out.conf_rev);
    case 0x89:
        return read_flag(field.value, out.nds_com);
    case 0x8A:
        return read_unsigned(field.value, out.declared_entries);
    case kAllData:
        out.all_data = field.value;
        out.all_data_offset = field.value_offset;
        return Reason::none;
    default: // security: reserved, not read
        return Reason::none;
    }
}

/// The bit of a field in GooseFrame::fields; 0 for unknown ones.
std::uint16_t bit_of(std::uint32_t tag) noexcept {
    if (tag >= kFirstGooseField && tag <= kLastPrimitive) {
        return static_cast<std::uint16_t>(1U << (tag - kFirstGooseField));
    }
    if (tag == kAllData) {
        return GooseFrame::all_data_field;
    }
    return tag == kGooseSecurity ? std::uint16_t{GooseFrame::security_field} : std::uint16_t{0};
}

Decoded<void> read_pdu(Tlv const& pdu, GooseFrame& out) noexcept {
    BerCursor cursor{pdu};
    Tlv field;
    while (!cursor.at_end()) {
        if (Reason const reason = cursor.next(field); reason != Reason::none) {
            return std::unexpected{field.error(reason)};
        }
        std::uint16_t const bit = bit_of(field.tag);
        if (bit == 0) {
            continue; // of a later edition
        }
        if ((out.fields & bit) != 0) {
            return std::unexpected{field.error(Reason::duplicate_field)};
        }
        out.fields |= bit;
        if (Reason const reason = read_field(field, out); reason != Reason::none) {
            return std::unexpected{field.error(reason)};
        }
    }
    if ((out.fields & kMandatoryGooseFields) != kMandatoryGooseFields) {
        auto const missing =
            static_cast<unsigned>(std::countr_zero(static_cast<unsigned>(kMandatoryGooseFields & ~out.fields)));
        return undecodable(Reason::missing_field, pdu.offset, missing == 11 ? kAllData : kFirstGooseField + missing);
    }
    return {};
}

} // namespace

Decoded<void> decode_goose(Octets frame, GooseFrame& out) noexcept {
    out = GooseFrame{};
    if (auto ok = decode_header(frame, out.header); !ok) {
        return ok;
    }
    if (out.header.ethertype != kGooseEthertype) {
        return undecodable(Reason::other_ethertype, out.header.apdu_offset - kHeaderOctets - 2);
    }
    Tlv pdu;
    BerCursor whole{out.header.apdu, out.header.apdu_offset};
    if (Reason const reason = whole.next(pdu); reason != Reason::none) {
        return std::unexpected{pdu.error(reason)};
    }
    if (pdu.tag != kGoosePdu) {
        return std::unexpected{pdu.error(Reason::bad_tag)};
    }
    if (auto ok = read_pdu(pdu, out); !ok) {
        return ok;
    }
    auto const members = check_data(out.all_data, out.all_data_offset);
    if (!members) {
        return std::unexpected{members.error()};
    }
    out.entries = *members;
    return {};
}

} // namespace gridspace::iec61850
