// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sv.hpp"

#include "gateways/iec61850/ber.hpp"

namespace gridspace::iec61850 {
namespace {

constexpr std::uint32_t kSavPdu = 0x60, kNoAsdu = 0x80, kSavSecurity = 0x81, kSeqAsdu = 0xA2, kAsdu = 0x30;
constexpr std::uint32_t kFirstAsduField = 0x80, kLastAsduField = 0x89;
constexpr std::uint16_t kMandatoryAsduFields =
    Asdu::sv_id_field | Asdu::smp_cnt_field | Asdu::conf_rev_field | Asdu::smp_synch_field | Asdu::sample_field;

Reason read_field(std::uint32_t tag, Octets value, Asdu& out) noexcept {
    switch (tag) {
    case 0x80:
        out.sv_id = text_of(value);
        return Reason::none;
    case 0x81:
        out.dat_set = text_of(value);
        return Reason::none;
    case 0x82:
        return read_unsigned(value, out.smp_cnt);
    case 0x83:
        return read_unsigned(value, out.conf_rev);
    case 0x84:
        if (value.size() != 8) {
            return Reason::bad_value;
        }
        out.refr_tm = UtcTime::from_bits(load_be<std::uint64_t>(value.data()));
        return Reason::none;
    case 0x85:
        return read_unsigned(value, out.smp_synch);
    case 0x86:
        return read_unsigned(value, out.smp_rate);
    case 0x87:
        out.sample = value;
        return Reason::none;
    case 0x88:
        return read_unsigned(value, out.smp_mod);
    default:
        if (value.size() != 8) {
            return Reason::bad_value;
        }
        out.gm_identity = load_be<std::uint64_t>(value.data());
        return Reason::none;
    }
}

Decoded<void> read_asdu(Tlv const& asdu, Asdu& out) noexcept {
    out = Asdu{};
    out.offset = asdu.offset;
    BerCursor cursor{asdu};
    Tlv field;
    while (!cursor.at_end()) {
        if (Reason const reason = cursor.next(field); reason != Reason::none) [[unlikely]] {
            return std::unexpected{field.error(reason)};
        }
        if (field.tag < kFirstAsduField || field.tag > kLastAsduField) [[unlikely]] {
            continue; // of a later edition
        }
        auto const bit = static_cast<std::uint16_t>(1U << (field.tag - kFirstAsduField));
        if ((out.fields & bit) != 0) [[unlikely]] {
            return std::unexpected{field.error(Reason::duplicate_field)};
        }
        out.fields |= bit;
        if (Reason const reason = read_field(field.tag, field.value, out); reason != Reason::none) [[unlikely]] {
            return std::unexpected{field.error(reason)};
        }
    }
    if ((out.fields & kMandatoryAsduFields) != kMandatoryAsduFields) [[unlikely]] {
        auto const missing = static_cast<unsigned>(kMandatoryAsduFields & ~out.fields);
        return undecodable(Reason::missing_field, asdu.offset,
                           kFirstAsduField + static_cast<unsigned>(std::countr_zero(missing)));
    }
    return {};
}

Decoded<void> read_sequence(Tlv const& sequence, SvFrame& out) noexcept {
    BerCursor cursor{sequence};
    Tlv asdu;
    while (!cursor.at_end()) {
        if (Reason const reason = cursor.next(asdu); reason != Reason::none) {
            return std::unexpected{asdu.error(reason)};
        }
        if (asdu.tag != kAsdu) {
            return std::unexpected{asdu.error(Reason::bad_tag)};
        }
        if (out.count == kMaxAsdus) {
            return std::unexpected{asdu.error(Reason::too_many)};
        }
        if (auto ok = read_asdu(asdu, out.asdus[out.count]); !ok) {
            return ok;
        }
        ++out.count;
    }
    return {};
}

/// Each element one by one, in any order and form.
[[gnu::cold]] Decoded<void> read_any_pdu(SvFrame& out) noexcept {
    out.count = 0;
    if (out.header.ethertype != kSvEthertype) {
        return undecodable(Reason::other_ethertype, out.header.apdu_offset - kHeaderOctets - 2);
    }
    Tlv pdu, part, sequence;
    BerCursor whole{out.header.apdu, out.header.apdu_offset};
    if (Reason const reason = whole.next(pdu); reason != Reason::none) {
        return std::unexpected{pdu.error(reason)};
    }
    if (pdu.tag != kSavPdu) {
        return std::unexpected{pdu.error(Reason::bad_tag)};
    }
    std::uint16_t declared = 0;
    bool counted = false, found = false;
    BerCursor cursor{pdu};
    while (!cursor.at_end()) {
        if (Reason const reason = cursor.next(part); reason != Reason::none) {
            return std::unexpected{part.error(reason)};
        }
        if (part.tag == kNoAsdu) {
            if (counted) {
                return std::unexpected{part.error(Reason::duplicate_field)};
            }
            counted = true;
            if (Reason const reason = read_unsigned(part.value, declared); reason != Reason::none) {
                return std::unexpected{part.error(reason)};
            }
        } else if (part.tag == kSeqAsdu) {
            if (found) {
                return std::unexpected{part.error(Reason::duplicate_field)};
            }
            found = true;
            sequence = part;
        } else if (part.tag == kSavSecurity) {
            out.secured = true;
        }
    }
    if (!counted || !found) {
        return undecodable(Reason::missing_field, pdu.offset, counted ? kSeqAsdu : kNoAsdu);
    }
    if (auto ok = read_sequence(sequence, out); !ok) {
        out.count = 0;
        return ok;
    }
    if (out.count == 0 || out.count != declared) {
        out.count = 0;
        return undecodable(Reason::count_mismatch, sequence.offset, kNoAsdu);
    }
    return {};
}

/// Steps into the element `tag` at `at`, which must be there with a length of one to three octets: `at` and `end`
/// become those of its value.
bool enter(std::uint8_t tag, std::uint8_t const*& at, std::uint8_t const*& end) noexcept {
    if (end - at < 2 || at[0] != tag) {
        return false;
    }
    std::ptrdiff_t length = at[1];
    at += 2;
    if (length >= 0x80) {
        std::ptrdiff_t const octets = length - 0x80;
        if (octets == 0 || octets > 2 || end - at < octets) {
            return false;
        }
        length = octets == 1 ? at[0] : load_be<std::uint16_t>(at);
        at += octets;
    }
    if (end - at < length) {
        return false;
    }
    end = at + length;
    return true;
}

/// The value of the element `tag` at `at`, which moves behind it.
bool take(std::uint8_t tag, std::uint8_t const*& at, std::uint8_t const* end, Octets& out) noexcept {
    if (!enter(tag, at, end)) {
        return false;
    }
    out = {at, end};
    at = end;
    return true;
}

/// An ASDU as nearly every publisher writes it: the standard's order, fixed widths. False: it is written in another
/// way, or wrong, and read_asdu() has to look; `out` then holds anything.
bool read_usual_asdu(std::uint8_t const* at, std::uint8_t const* end, Asdu& out) noexcept {
    constexpr std::ptrdiff_t kCounters = 10, kSynch = 3, kHead = 2; // smpCnt and confRev; smpSynch; tag and length
    auto const has = [&](std::ptrdiff_t octets) { return end - at >= octets; };
    std::uint16_t fields = kMandatoryAsduFields;
    Octets name, set;

    if (!take(0x80, at, end, name) || !has(kCounters + kSynch)) {
        return false;
    }
    if (at[0] == 0x81) {
        if (!take(0x81, at, end, set) || !has(kCounters + kSynch)) {
            return false;
        }
        fields |= Asdu::dat_set_field;
    }
    if (load_be<std::uint16_t>(at) != 0x8202 || load_be<std::uint16_t>(at + 4) != 0x8304) {
        return false;
    }
    out.sv_id = text_of(name);
    out.dat_set = text_of(set);
    out.smp_cnt = load_be<std::uint16_t>(at + 2);
    out.conf_rev = load_be<std::uint32_t>(at + 6);
    at += kCounters;
    out.refr_tm = {};
    if (at[0] == 0x84) {
        if (at[1] != 8 || !has(kHead + 8 + kSynch)) {
            return false;
        }
        out.refr_tm = UtcTime::from_bits(load_be<std::uint64_t>(at + kHead));
        fields |= Asdu::refr_tm_field;
        at += kHead + 8;
    }
    if (load_be<std::uint16_t>(at) != 0x8501) {
        return false;
    }
    out.smp_synch = at[2];
    at += kSynch;
    out.smp_rate = 0;
    if (has(kHead + 2) && load_be<std::uint16_t>(at) == 0x8602) {
        out.smp_rate = load_be<std::uint16_t>(at + kHead);
        fields |= Asdu::smp_rate_field;
        at += kHead + 2;
    }
    if (!take(0x87, at, end, out.sample)) {
        return false;
    }
    out.smp_mod = 0;
    out.gm_identity = 0;
    if (at != end) {
        if (has(kHead + 2) && load_be<std::uint16_t>(at) == 0x8802) {
            out.smp_mod = load_be<std::uint16_t>(at + kHead);
            fields |= Asdu::smp_mod_field;
            at += kHead + 2;
        }
        if (has(kHead + 8) && load_be<std::uint16_t>(at) == 0x8908) {
            out.gm_identity = load_be<std::uint64_t>(at + kHead);
            fields |= Asdu::gm_identity_field;
            at += kHead + 8;
        }
    }
    out.fields = fields;
    return at == end;
}

/// A PDU as nearly every publisher writes it. False: read_any_pdu() has to look, and says what is wrong, if anything
/// is.
bool read_usual_pdu(FrameHeader const& header, SvFrame& out) noexcept {
    std::uint8_t const* at = header.apdu.data();
    std::uint8_t const* end = at + header.apdu.size();
    std::uint8_t const* const frame = at - header.apdu_offset;
    if (!enter(0x60, at, end) || end - at < 3 || load_be<std::uint16_t>(at) != 0x8001) {
        return false;
    }
    std::size_t const declared = at[2];
    at += 3;
    std::uint8_t const* const end_of_pdu = end;
    if (declared > kMaxAsdus || !enter(0xA2, at, end) || end != end_of_pdu) {
        return false;
    }
    std::size_t count = 0;
    for (; at != end && count < declared; ++count) {
        Asdu& asdu = out.asdus[count];
        asdu.offset = static_cast<std::uint32_t>(at - frame);
        std::uint8_t const* end_of_asdu = end;
        if (!enter(0x30, at, end_of_asdu) || !read_usual_asdu(at, end_of_asdu, asdu)) {
            return false;
        }
        at = end_of_asdu;
    }
    out.count = static_cast<std::uint16_t>(count);
    return count != 0 && count == declared && at == end;
}

} // namespace

Decoded<void> decode_sv(Octets frame, SvFrame& out) noexcept {
    out.secured = false;
    if (auto bad = decode_header(frame, out.header); !bad) [[unlikely]] {
        out.count = 0;
        return bad;
    }
    if (out.header.ethertype == kSvEthertype && read_usual_pdu(out.header, out)) [[likely]] {
        return {};
    }
    return read_any_pdu(out);
}

Decoded<void> decode_sv_without_shortcut(Octets frame, SvFrame& out) noexcept {
    out.secured = false;
    out.count = 0;
    auto ok = decode_header(frame, out.header);
    return ok ? read_any_pdu(out) : ok;
}

} // namespace gridspace::iec61850
