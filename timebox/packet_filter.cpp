// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_filter.hpp"

#include <algorithm>
#include <array>
#include <net/if_arp.h>

namespace gridspace::timebox {
namespace {

constexpr std::uint16_t kReturnA = 0x10; // BPF_A of libpcap's headers
constexpr std::array kAncillary{SKF_AD_PROTOCOL, SKF_AD_PKTTYPE,          SKF_AD_IFINDEX,  SKF_AD_HATYPE,
                                SKF_AD_VLAN_TAG, SKF_AD_VLAN_TAG_PRESENT, SKF_AD_VLAN_TPID};

std::uint32_t ancillary(FilterInput const& input, int what) {
    switch (what) {
    case SKF_AD_PROTOCOL:
        return input.protocol;
    case SKF_AD_PKTTYPE:
        return input.packet_type;
    case SKF_AD_IFINDEX:
        return static_cast<std::uint32_t>(input.interface);
    case SKF_AD_HATYPE:
        return ARPHRD_ETHER;
    case SKF_AD_VLAN_TAG:
        return input.vlan_tci.value_or(0);
    case SKF_AD_VLAN_TAG_PRESENT:
        return input.vlan_tci ? 1 : 0;
    default:
        return input.vlan_protocol;
    }
}

/// `size` octets at `offset`, in the order of the network; nothing: beyond the frame.
std::optional<std::uint32_t> load(FilterInput const& input, std::uint32_t offset, std::size_t size) {
    auto at = static_cast<std::int64_t>(static_cast<std::int32_t>(offset));
    if (at < 0 && at >= SKF_AD_OFF) {
        return ancillary(input, static_cast<int>(at - SKF_AD_OFF));
    }
    if (at < 0 && at >= SKF_NET_OFF) {
        at += static_cast<std::int64_t>(input.network_offset) - SKF_NET_OFF;
    } else if (at < 0 && at >= SKF_LL_OFF) {
        at -= SKF_LL_OFF;
    }
    if (at < 0 || static_cast<std::size_t>(at) + size > input.octets.size()) {
        return std::nullopt;
    }
    std::uint32_t out = 0;
    for (std::size_t i = 0; i < size; ++i) {
        out = out << 8U | input.octets[static_cast<std::size_t>(at) + i];
    }
    return out;
}

std::size_t size_of(sock_filter const& f) {
    return BPF_SIZE(f.code) == BPF_W ? 4 : BPF_SIZE(f.code) == BPF_H ? 2 : 1;
}

/// The result of an operation; nothing: division by zero.
std::optional<std::uint32_t> compute(std::uint16_t operation, std::uint32_t a, std::uint32_t b) {
    switch (operation) {
    case BPF_ADD:
        return a + b;
    case BPF_SUB:
        return a - b;
    case BPF_MUL:
        return a * b;
    case BPF_DIV:
        return b == 0 ? std::nullopt : std::optional{a / b};
    case BPF_MOD:
        return b == 0 ? std::nullopt : std::optional{a % b};
    case BPF_OR:
        return a | b;
    case BPF_AND:
        return a & b;
    case BPF_XOR:
        return a ^ b;
    case BPF_LSH:
        return b < 32 ? a << b : 0;
    case BPF_RSH:
        return b < 32 ? a >> b : 0;
    default:
        return 0U - a; // BPF_NEG
    }
}

bool is_sound_operation(sock_filter const& f) {
    std::uint16_t const operation = BPF_OP(f.code);
    bool const by_constant = BPF_SRC(f.code) == BPF_K;
    bool const division = operation == BPF_DIV || operation == BPF_MOD;
    bool const shift = operation == BPF_LSH || operation == BPF_RSH;
    return operation <= BPF_XOR && !(division && by_constant && f.k == 0) && !(shift && by_constant && f.k >= 32) &&
           (operation != BPF_NEG || by_constant);
}

bool holds(std::uint16_t comparison, std::uint32_t a, std::uint32_t b) {
    return comparison == BPF_JEQ   ? a == b
           : comparison == BPF_JGT ? a > b
           : comparison == BPF_JGE ? a >= b
                                   : (a & b) != 0;
}

} // namespace

std::optional<PacketFilter> PacketFilter::make(std::vector<sock_filter> program) {
    if (program.empty() || program.size() > BPF_MAXINSNS || BPF_CLASS(program.back().code) != BPF_RET) {
        return std::nullopt;
    }
    for (std::size_t at = 0; at < program.size(); ++at) {
        sock_filter const& f = program[at];
        std::uint16_t const kind = BPF_CLASS(f.code), operation = BPF_OP(f.code);
        std::size_t const left = program.size() - at - 1;
        auto const k = static_cast<std::int32_t>(f.k);
        bool const ancillary_load = kind == BPF_LD && BPF_MODE(f.code) == BPF_ABS && k < 0 && k >= SKF_AD_OFF;
        bool const memory =
            ((kind == BPF_LD || kind == BPF_LDX) && BPF_MODE(f.code) == BPF_MEM) || kind == BPF_ST || kind == BPF_STX;
        if ((ancillary_load && std::find(kAncillary.begin(), kAncillary.end(), k - SKF_AD_OFF) == kAncillary.end()) ||
            (memory && f.k >= BPF_MEMWORDS) || (kind == BPF_ALU && !is_sound_operation(f)) ||
            (kind == BPF_JMP &&
             (operation == BPF_JA ? f.k >= left : operation > BPF_JSET || f.jt >= left || f.jf >= left))) {
            return std::nullopt;
        }
    }
    return PacketFilter{std::move(program)};
}

std::uint32_t PacketFilter::run(FilterInput const& input) const {
    std::uint32_t a = 0, x = 0;
    std::array<std::uint32_t, BPF_MEMWORDS> memory{};
    for (std::size_t at = 0; at < program_.size(); ++at) { // jumps go forwards only
        sock_filter const& f = program_[at];
        std::uint32_t const operand = BPF_SRC(f.code) == BPF_X ? x : f.k;
        std::optional<std::uint32_t> value;
        switch (BPF_CLASS(f.code)) {
        case BPF_LD:
        case BPF_LDX:
            switch (BPF_MODE(f.code)) {
            case BPF_IMM:
                value = f.k;
                break;
            case BPF_LEN:
                value = static_cast<std::uint32_t>(input.octets.size());
                break;
            case BPF_MEM:
                value = memory[f.k];
                break;
            case BPF_MSH:
                value = load(input, f.k, 1);
                value = value ? std::optional{(*value & 0xFU) << 2U} : std::nullopt;
                break;
            default:
                value = load(input, BPF_MODE(f.code) == BPF_IND ? x + f.k : f.k, size_of(f));
            }
            if (!value) {
                return 0;
            }
            (BPF_CLASS(f.code) == BPF_LD ? a : x) = *value;
            break;
        case BPF_ST:
            memory[f.k] = a;
            break;
        case BPF_STX:
            memory[f.k] = x;
            break;
        case BPF_ALU:
            value = compute(BPF_OP(f.code), a, operand);
            if (!value) {
                return 0;
            }
            a = *value;
            break;
        case BPF_JMP:
            at += BPF_OP(f.code) == BPF_JA ? f.k : holds(BPF_OP(f.code), a, operand) ? f.jt : f.jf;
            break;
        case BPF_RET:
            return BPF_RVAL(f.code) == kReturnA ? a : f.k;
        default: // BPF_MISC
            (BPF_MISCOP(f.code) == BPF_TAX ? x : a) = BPF_MISCOP(f.code) == BPF_TAX ? a : x;
        }
    }
    return 0;
}

} // namespace gridspace::timebox
