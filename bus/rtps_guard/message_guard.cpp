// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/message_guard.hpp"

#include "bus/rtps_guard/parameter_guard.hpp"
#include "bus/rtps_guard/submessages.hpp"
#include "bus/rtps_guard/token_guard.hpp"

#include <algorithm>

namespace gridspace::rtps_guard {
namespace {

constexpr std::size_t kStatisticsOctets = 56;
constexpr EntityId kUnknownEntity = 0;
constexpr EntityId kParticipantWriter = 0x000100c2, kPublicationsWriter = 0x000003c2, kSubscriptionsWriter = 0x000004c2,
                   kLivelinessWriter = 0x000200c2, kHandshakeWriter = 0x000201c3;
constexpr std::size_t kCryptoHeader = 20, kCryptoFooter = 20; ///< DDS Security 1.1, 9.5.2.3 and 9.5.2.5
/// Sequence numbers count from 1, and the library walks through what a writer says to be past, one at a time (some 100
/// ns each, the reader locked). A writer of discovery says little; 28,800 samples a second reach the other bound in 20
/// h.
constexpr std::int64_t kLargestOfDiscovery = std::int64_t{1} << 20U, kLargestNumber = std::int64_t{1} << 31U;
constexpr std::int64_t kLongestGap = std::int64_t{1} << 20U;
constexpr std::uint32_t kLongestSet = 256;

/// Built-in writers and readers carry discovery; 0xc0 in the last octet (9.3.1.2).
bool is_builtin(EntityId id) {
    return (id & 0xc0U) == 0xc0U;
}
bool describes_entities(EntityId writer) {
    return writer == kParticipantWriter || writer == kPublicationsWriter || writer == kSubscriptionsWriter;
}

/// The reader and the writer that a submessage is about.
struct Ends {
    explicit Ends(Octets& body) : reader{body.entity()}, writer{body.entity()} {}
    EntityId reader, writer;
    [[nodiscard]] bool builtin() const { return is_builtin(reader) || is_builtin(writer); }
    [[nodiscard]] bool reach(std::int64_t number, std::int64_t least = 1) const {
        return number >= least && number < (builtin() ? kLargestOfDiscovery : kLargestNumber);
    }
};

/// The bits of a set of sequence or fragment numbers that `base` has begun.
bool skip_set(Octets& body) {
    std::uint32_t const bits = body.u32();
    body.skip(std::size_t{4} * ((std::min(bits, kLongestSet) + 31) / 32));
    return body.ok() && bits <= kLongestSet;
}

class Walk {
  public:
    Walk(Examined& out, Rules rules) : out_{out}, rules_{rules}, speaker_{out.source} {}

    Refusal of(Submessage s) {
        if (rules_.secured) {
            bool const framing = s.kind >= kSecureBody && s.kind <= kSecureMessagePostfix;
            if (Refusal const refusal = framing ? frame(s) : frame_of(s); framing || refusal != Refusal::none) {
                begun_ = true;
                return refusal;
            }
            begun_ = true;
        }
        return content(s);
    }

    /// Whether all that was opened is closed.
    [[nodiscard]] bool complete() const { return message_ != Frame::open && submessage_ != Frame::open; }

  private:
    enum class Frame : std::uint8_t { none, open, closed };

    /// What protection looks like from outside. The library believes the length in a body.
    Refusal frame(Submessage s) {
        switch (s.kind) {
        case kSecureMessagePrefix:
            if (begun_ || !enough(s.body, kCryptoHeader)) {
                return Refusal::content;
            }
            message_ = Frame::open;
            return Refusal::none;
        case kSecurePrefix:
            if (submessage_ == Frame::open || message_ == Frame::closed || !enough(s.body, kCryptoHeader)) {
                return Refusal::content;
            }
            submessage_ = Frame::open;
            return Refusal::none;
        case kSecureBody: {
            s.body.little(false);
            std::uint32_t const octets = s.body.u32();
            bool const inside = message_ == Frame::open || submessage_ == Frame::open;
            return content_if(!inside || !s.body.ok() || octets > s.body.left());
        }
        case kSecurePostfix:
            if (submessage_ != Frame::open || !enough(s.body, kCryptoFooter)) {
                return Refusal::content;
            }
            submessage_ = Frame::closed;
            return Refusal::none;
        default:
            if (message_ != Frame::open || submessage_ == Frame::open || !enough(s.body, kCryptoFooter)) {
                return Refusal::content;
            }
            message_ = Frame::closed;
            return Refusal::none;
        }
    }

    /// What stands outside of any protection: the way into it, and nothing else.
    [[nodiscard]] Refusal frame_of(Submessage const& s) const {
        if (message_ == Frame::closed) {
            return Refusal::content;
        }
        if (message_ == Frame::open || submessage_ == Frame::open) {
            return Refusal::none;
        }
        switch (s.kind) {
        case kPad:
        case kInfoTs:
        case kInfoSrc:
        case kInfoDst:
        case kInfoReply:
        case kInfoReplyIp4:
            return Refusal::none;
        case kHeartbeat:
        case kAckNack:
        case kGap: { // of plain discovery, which is there where messages are not signed as a whole, and carries nothing
            Octets body = s.body;
            EntityId const writer = Ends{body}.writer;
            bool const empty =
                writer == kPublicationsWriter || writer == kSubscriptionsWriter || writer == kLivelinessWriter;
            return empty ? Refusal::none : Refusal::unprotected;
        }
        case kData: {
            Octets body = s.body;
            body.skip(4);
            Ends const ends{body};
            bool const is_word = (s.flags & 4U) != 0;
            bool const before = ends.writer == kParticipantWriter || ends.writer == kHandshakeWriter;
            return !before   ? Refusal::unprotected
                   : is_word ? Refusal::none
                             : Refusal::farewell; // anybody could say that
        }
        default:
            return Refusal::unprotected;
        }
    }

    Refusal content(Submessage s) {
        switch (s.kind) {
        case kData:
        case kDataFrag:
            return data(s);
        case kHeartbeat:
            return heartbeat(s.body);
        case kAckNack:
            return acknowledgement(s.body);
        case kGap:
            return gap(s.body);
        case kNackFrag:
            return fragments(s.body, true);
        case kHeartbeatFrag:
            return fragments(s.body, false);
        case kInfoTs:
            return (s.flags & 2U) != 0 || enough(s.body, 8) ? Refusal::none : Refusal::content;
        case kInfoDst:
            return enough(s.body, sizeof(GuidPrefix)) ? Refusal::none : Refusal::content;
        case kInfoSrc: // CycloneDDS puts what several participants of a process say into one message
            s.body.skip(8);
            speaker_ = s.body.prefix();
            return content_if(!s.body.ok() || speaker_ == GuidPrefix{});
        default:
            return s.kind >= kSecureBody && s.kind <= kSecureMessagePostfix ? Refusal::kind : Refusal::none;
        }
    }

    static bool enough(Octets const& body, std::size_t octets) { return body.ok() && body.left() >= octets; }

    static Refusal content_if(bool wrong) { return wrong ? Refusal::content : Refusal::none; }

    static Refusal heartbeat(Octets body) {
        Ends const ends{body};
        std::int64_t const first = body.sequence_number(), last = body.sequence_number();
        return content_if(!ends.reach(first) || !ends.reach(last, first - 1) || !enough(body, 4));
    }
    static Refusal acknowledgement(Octets body) {
        Ends const ends{body};
        return content_if(!ends.reach(body.sequence_number(), 0) || !skip_set(body) || !enough(body, 4));
    }
    static Refusal gap(Octets body) {
        Ends const ends{body};
        std::int64_t const first = body.sequence_number(), beyond = body.sequence_number();
        return content_if(!ends.reach(first) || !ends.reach(beyond) || beyond - first > kLongestGap || !skip_set(body));
    }
    static Refusal fragments(Octets body, bool are_missing) {
        Ends const ends{body};
        return content_if(!ends.reach(body.sequence_number()) || body.u32() == 0 || (are_missing && !skip_set(body)) ||
                          !enough(body, 4));
    }

    Refusal data(Submessage s) {
        bool const fragment = s.kind == kDataFrag;
        bool const has_qos = (s.flags & 2U) != 0;
        bool const has_data = fragment ? (s.flags & 4U) == 0 : (s.flags & 4U) != 0;
        bool const has_key = fragment ? (s.flags & 4U) != 0 : (s.flags & 8U) != 0;
        s.body.skip(2);
        std::size_t const to_qos = s.body.u16(), counted_from = s.body.at();
        Ends const ends{s.body};
        EntityId const reader = ends.reader, writer = ends.writer;
        if (!ends.reach(s.body.sequence_number()) || (has_data && has_key)) {
            return Refusal::content;
        }
        std::uint64_t const in_fragments = fragment ? octets_of_fragments(s.body) : 0;
        if (fragment && (in_fragments == 0 || !has_data)) {
            return Refusal::content;
        }
        std::size_t const read = s.body.at() - counted_from;
        if (!s.body.ok() || to_qos < read || to_qos > INT16_MAX) {
            return Refusal::content;
        }
        s.body.skip(to_qos - read);
        if (ends.builtin() && (fragment || !is_builtin(writer) || (reader != kUnknownEntity && !is_builtin(reader)))) {
            return Refusal::content; // discovery is never so long, and never mixed with what users send
        }
        if (has_qos) {
            auto const facts = examine_parameters(s.body, false);
            if (!facts) {
                return Refusal::parameters;
            }
            if (describes_entities(writer) && !is_from_source(facts->key)) {
                return Refusal::identity;
            }
            s.body.skip(facts->octets);
        }
        if (!s.body.ok() || ((has_data || has_key) && s.body.left() == 0) || s.body.left() < in_fragments) {
            return Refusal::content;
        }
        // What is signed cannot be put together here: the library's own business, with members only.
        out_.has_fragments = out_.has_fragments || (fragment && !rules_.secured);
        if (writer == kHandshakeWriter && has_data && !is_generic_message(s.body)) {
            return Refusal::content;
        }
        if (writer == kLivelinessWriter && (has_data || has_key) && s.body.left() < 4 + sizeof(GuidPrefix) + 4) {
            return Refusal::content;
        }
        return describes_entities(writer) && (has_data || has_key) ? entity(writer, s.body) : Refusal::none;
    }

    /// Of the sample, in the fragments that follow; 0 when their numbers cannot be.
    static std::uint64_t octets_of_fragments(Octets& body) {
        std::uint64_t const first = body.u32(), count = body.u16(), size = body.u16(), whole = body.u32();
        bool const inside = body.ok() && first > 0 && count > 0 && size > 0 && whole <= kLongestSample &&
                            (first - 1 + count - 1) * size < whole;
        return inside ? std::min(count * size, whole - (first - 1) * size) : 0;
    }

    /// A participant or an endpoint announces itself, or says that it goes.
    Refusal entity(EntityId writer, Octets body) {
        auto const encapsulation = body.take(4);
        if (!body.ok() || encapsulation[0] != 0 || (encapsulation[1] != 2 && encapsulation[1] != 3)) {
            return Refusal::parameters; // PL_CDR_BE or PL_CDR_LE
        }
        body.little(encapsulation[1] == 3);
        auto const facts = examine_parameters(body, true, rules_.secured);
        if (!facts) {
            return Refusal::parameters;
        }
        auto const& who = writer == kParticipantWriter ? facts->participant : facts->endpoint;
        if (!is_from_source(who) || !is_from_source(facts->participant) || !is_from_source(facts->key)) {
            return Refusal::identity;
        }
        if (writer == kParticipantWriter && who) {
            if (out_.announced_count == out_.announced.size()) {
                return Refusal::identity;
            }
            out_.announced[out_.announced_count++] = *who;
        }
        return Refusal::none;
    }

    [[nodiscard]] bool is_from_source(std::optional<GuidPrefix> const& prefix) const {
        return !rules_.speaks_for_itself || !prefix || *prefix == speaker_;
    }

    Examined& out_;
    Rules rules_;
    GuidPrefix speaker_; ///< of the submessages from here on
    bool begun_{false};  ///< something stands before
    Frame message_{Frame::none}, submessage_{Frame::none};
};

Refusal walk(std::span<std::uint8_t> datagram, Rules rules, Examined& out) {
    constexpr std::array<std::uint8_t, 5> kMagic{'R', 'T', 'P', 'S', 2};
    Octets octets{datagram};
    if (datagram.size() < kHeader || !std::equal(kMagic.begin(), kMagic.end(), datagram.begin())) {
        return Refusal::not_rtps;
    }
    octets.skip(8);
    out.source = octets.prefix();
    if (out.source == GuidPrefix{}) {
        return Refusal::not_rtps;
    }
    out.octets = datagram.size();
    Walk walk{out, rules};
    while (octets.left() > 0) {
        std::size_t const begin = octets.at();
        auto const submessage = next_submessage(octets);
        if (!submessage) {
            return Refusal::submessage;
        }
        if (submessage->kind == kStatistics && submessage->body.left() == kStatisticsOctets && octets.left() == 0) {
            out.octets = begin; // nobody here asks for them, and the library ends itself over the least mistake in them
            break;
        }
        if (submessage->kind == kStatistics) {
            return Refusal::kind;
        }
        if (Refusal const refusal = walk.of(*submessage); refusal != Refusal::none) {
            return refusal;
        }
    }
    return walk.complete() ? Refusal::none : Refusal::content;
}

} // namespace

std::string_view to_string(Refusal refusal) {
    switch (refusal) {
    case Refusal::not_rtps:
        return "not RTPS 2";
    case Refusal::submessage:
        return "a submessage longer than the datagram";
    case Refusal::kind:
        return "a submessage that nobody sends here";
    case Refusal::content:
        return "numbers that cannot be";
    case Refusal::parameters:
        return "a damaged parameter list";
    case Refusal::identity:
        return "speaks for another participant";
    case Refusal::stranger:
        return "from a participant that has not announced itself";
    case Refusal::crowd:
        return "one participant too many";
    case Refusal::unprotected:
        return "without the protection of this bus";
    case Refusal::farewell:
        return "a farewell that anybody can say";
    case Refusal::none:
    case Refusal::count_:
        break;
    }
    return "";
}

Examined examine(std::span<std::uint8_t> datagram, Rules rules) {
    Examined out;
    out.refusal = walk(datagram, rules, out);
    return out;
}

} // namespace gridspace::rtps_guard
