// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/authentication_impl.hpp"
#include "bus/directory_impl.hpp"
#include "bus/discovery_impl.hpp"
#include "bus/machine.hpp"
#include "bus/participant.hpp"
#include "common/text.hpp"

#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fmt/format.h>
#include <string>
#include <string_view>

namespace gridspace::bus {

inline constexpr std::string_view kUserDataMark = "gridspace/1";

/// What a participant of ours says about itself when it is discovered.
[[nodiscard]] inline std::string user_data_of(ParticipantOptions const& options) {
    return fmt::format("{};process={};incarnation={};program={};machine={}", kUserDataMark, options.process,
                       options.incarnation, options.program, this_machine());
}

/// A participant of another make may take part as a member: its entity name is then its process name.
[[nodiscard]] inline Peer peer_of(rtps::ParticipantProxyData const& data) {
    Peer peer{std::string{data.m_participantName.c_str()}, 0, "", ""};
    std::string const text{data.m_userData.begin(), data.m_userData.end()};
    if (!text.starts_with(kUserDataMark)) {
        return peer;
    }
    for (std::string const& part : split(text, ';')) {
        if (part.starts_with("process=")) {
            peer.process = part.substr(8);
        } else if (part.starts_with("incarnation=")) {
            peer.incarnation = static_cast<std::uint32_t>(std::strtoul(part.c_str() + 12, nullptr, 10));
        } else if (part.starts_with("program=")) {
            peer.program = part.substr(8);
        } else if (part.starts_with("machine=")) {
            peer.machine = part.substr(8);
        }
    }
    return peer;
}

/// Tells the directory and an observer who comes, goes, and shows who he is.
class ParticipantListener final : public dds::DomainParticipantListener {
  public:
    ParticipantListener(Directory& directory, KnownEndpoints& endpoints, DiscoveryObserver* observer)
        : directory_{directory}, endpoints_{endpoints}, observer_{observer} {}
    void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& found) override {
        using Info = rtps::ParticipantDiscoveryInfo;
        rtps::GuidPrefix_t const& prefix = found.info.m_guid.guidPrefix;
        bool const leaves = found.status == Info::REMOVED_PARTICIPANT || found.status == Info::DROPPED_PARTICIPANT;
        if (secured_ && (leaves ? !authentication_.gone(prefix)
                                : !authentication_.announced(prefix, peer_of(found.info), addresses_of(found.info)))) {
            return;
        }
        if (observer_ != nullptr) {
            if (leaves) {
                observer_->participant_gone(id_of(prefix), found.status == Info::REMOVED_PARTICIPANT);
            } else {
                observer_->participant_found({id_of(prefix), peer_of(found.info), addresses_of(found.info)});
            }
        }
        switch (found.status) {
        case Info::DISCOVERED_PARTICIPANT:
        case Info::CHANGED_QOS_PARTICIPANT:
            directory_.announce(prefix, peer_of(found.info));
            break;
        case Info::REMOVED_PARTICIPANT:
            directory_.depart(prefix, true);
            break;
        case Info::DROPPED_PARTICIPANT:
            directory_.depart(prefix, false);
            break;
        }
    }

    void onParticipantAuthentication(dds::DomainParticipant*, rtps::ParticipantAuthenticationInfo&& info) override {
        rtps::GuidPrefix_t const& prefix = info.guid.guidPrefix;
        if (info.status == rtps::ParticipantAuthenticationInfo::AUTHORIZED_PARTICIPANT) {
            if (auto const who = authentication_.authorized(prefix)) {
                if (observer_ != nullptr) {
                    observer_->participant_found({id_of(prefix), who->peer, who->addresses});
                }
                directory_.announce(prefix, who->peer);
            }
        } else if (auto const text = authentication_.refused(prefix)) {
            tell_unauthenticated(*text);
        }
    }

    /// DDS Security is on: nobody is here who has not shown who he is. Before the participant is made.
    void secure() { secured_ = true; }

    void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) override {
        keep(found.info, true, found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
        if (observer_ != nullptr) {
            if (found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
                observer_->endpoint_gone(id_of(found.info.guid()));
            } else {
                observer_->endpoint_found(endpoint_of(found.info, true));
            }
        }
    }
    void on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& found) override {
        keep(found.info, false, found.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
        if (observer_ != nullptr) {
            if (found.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
                observer_->endpoint_gone(id_of(found.info.guid()));
            } else {
                observer_->endpoint_found(endpoint_of(found.info, false));
            }
        }
    }

  private:
    template <class Data>
    void keep(Data const& endpoint, bool writer, bool gone) {
        if (gone) {
            endpoints_.gone(endpoint.guid());
        } else {
            endpoints_.found(endpoint.guid(), std::string{endpoint.topicName().c_str()}, writer);
        }
    }

    Directory& directory_;
    KnownEndpoints& endpoints_;
    DiscoveryObserver* observer_;
    bool secured_{false};
    Authentication authentication_;
};

} // namespace gridspace::bus
