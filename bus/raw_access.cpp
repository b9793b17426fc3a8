// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/raw_access_impl.hpp"

#include "common/unique_fd.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fastdds/rtps/transport/TCPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <openssl/conf.h>
#include <openssl/ssl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gridspace::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::TCPv4TransportDescriptor;

/// Of one process on the other side, of which one listens: that many numbers are asked for (the default is four).
constexpr std::uint32_t kMaxParticipants = 24;

/// Fast DDS would throw, or end a thread, on a file that it cannot read.
Result<void> check_readable(std::filesystem::path const& file, char const* what) {
    if (::access(file.c_str(), R_OK) != 0) {
        return fail(ExitCode::usage, fmt::format("cannot read the {} '{}'", what, file.string()));
    }
    return {};
}

/// Fast DDS would only write a log line when somebody else has the port.
Result<void> check_free(std::uint16_t port) {
    UniqueFd const fd{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    int const yes = 1;
    ::setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_port = htons(port);
    if (::bind(fd.get(), reinterpret_cast<sockaddr const*>(&any), sizeof any) != 0) {
        return fail(ExitCode::environment, fmt::format("cannot listen at port {}: {}", port, std::strerror(errno)));
    }
    return {};
}

/// The IPv4 address of a host, which may be written as one.
Result<std::string> resolve(std::string const& host) {
    addrinfo hints{};
    hints.ai_family = AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (int const error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0) {
        return fail(ExitCode::environment, fmt::format("cannot find the host '{}': {}", host, ::gai_strerror(error)));
    }
    char text[INET_ADDRSTRLEN]{};
    ::inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in const*>(found->ai_addr)->sin_addr, text, sizeof text);
    ::freeaddrinfo(found);
    return std::string{text};
}

/// The listening side of Fast DDS 2.9 never asks for a certificate, whatever its verify mode is. OpenSSL's own defaults
/// do (qos/openssl.cnf says the same for programs that take TLS from a profile). They hold for the whole process.
Result<void> require_certificates() {
    constexpr std::string_view kDefaults = "openssl_conf = all\n[all]\nssl_conf = ssl\n[ssl]\nsystem_default = tls\n"
                                           "[tls]\nVerifyMode = Require\nMinProtocol = TLSv1.2\n";
    UniqueFd const file{::memfd_create("openssl.cnf", MFD_CLOEXEC)};
    bool const written =
        ::write(file.get(), kDefaults.data(), kDefaults.size()) == static_cast<ssize_t>(kDefaults.size());
    bool const loaded =
        written && ::CONF_modules_load_file(fmt::format("/proc/self/fd/{}", file.get()).c_str(), nullptr, 0) > 0;
    std::unique_ptr<SSL_CTX, void (*)(SSL_CTX*)> const probe{::SSL_CTX_new(::TLS_method()), ::SSL_CTX_free};
    if (!loaded || probe == nullptr ||
        ::SSL_CTX_get_verify_mode(probe.get()) != (SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT)) {
        return fail(ExitCode::environment,
                    "OpenSSL does not take the setting that asks the other side for its certificate");
    }
    return {};
}

Result<void> secure(TcpLink::Tls const& tls, TCPv4TransportDescriptor& tcp) {
    if (auto ok = require_certificates(); !ok) {
        return ok;
    }
    for (auto const& [file, what] : {std::pair{&tls.certificate, "certificate"},
                                     {&tls.private_key, "private key"},
                                     {&tls.authority, "authority's certificate"}}) {
        if (auto ok = check_readable(*file, what); !ok) {
            return ok;
        }
    }
    using Tls = TCPv4TransportDescriptor::TLSConfig;
    tcp.apply_security = true;
    tcp.tls_config.cert_chain_file = tls.certificate.string();
    tcp.tls_config.private_key_file = tls.private_key.string();
    tcp.tls_config.verify_file = tls.authority.string();
    tcp.tls_config.add_verify_mode(Tls::TLSVerifyMode::VERIFY_PEER);
    tcp.tls_config.add_verify_mode(Tls::TLSVerifyMode::VERIFY_FAIL_IF_NO_PEER_CERT);
    for (auto const option :
         {Tls::TLSOptions::DEFAULT_WORKAROUNDS, Tls::TLSOptions::NO_COMPRESSION, Tls::TLSOptions::NO_SSLV2,
          Tls::TLSOptions::NO_SSLV3, Tls::TLSOptions::NO_TLSV1, Tls::TLSOptions::NO_TLSV1_1}) {
        tcp.tls_config.add_option(option);
    }
    return {};
}

template <class Qos>
void apply_common(EndpointQos const& like, Qos& qos) {
    qos.reliability().kind = like.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind =
        like.durability == Durability::volatile_ ? dds::VOLATILE_DURABILITY_QOS : dds::TRANSIENT_LOCAL_DURABILITY_QOS;
}

} // namespace

Result<void> apply(TcpLink const& link, dds::DomainParticipantQos& qos) {
    auto tcp = std::make_shared<TCPv4TransportDescriptor>();
    tcp->sendBufferSize = tcp->receiveBufferSize = 1U << 20U;
    tcp->enable_tcp_nodelay = true;
    if (link.listens) {
        if (auto ok = check_free(link.port); !ok) {
            return ok;
        }
        tcp->add_listener_port(
            link.port); // on all interfaces: with a list of them, 2.9.1 connects to itself and to nobody else
    } else {
        rtps::Locator_t peer;
        peer.kind = LOCATOR_KIND_TCPv4;
        auto const address = resolve(link.address);
        if (!address) {
            return std::unexpected{address.error()};
        }
        rtps::IPLocator::setIPv4(peer, *address);
        rtps::IPLocator::setPhysicalPort(peer, link.port);
        tcp->maxInitialPeersRange = kMaxParticipants;
        qos.wire_protocol().builtin.initialPeersList.clear();
        qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    if (link.tls) {
        if (auto ok = secure(*link.tls, *tcp); !ok) {
            return ok;
        }
    }
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.clear();
    qos.transport().user_transports.push_back(std::move(tcp));
    return {};
}

void apply(EndpointQos const& like, dds::DataReaderQos& qos) {
    apply_common(like, qos);
    qos.ownership().kind = like.exclusive ? dds::EXCLUSIVE_OWNERSHIP_QOS : dds::SHARED_OWNERSHIP_QOS;
    qos.latency_budget().duration = eprosima::fastrtps::c_TimeInfinite; // whatever a writer allows itself
}

void apply(EndpointQos const& like, std::int32_t depth, dds::DataWriterQos& qos) {
    apply_common(like, qos);
    if (like.deadline_s > 0) {
        qos.deadline().period = eprosima::fastrtps::Duration_t{static_cast<long double>(like.deadline_s)};
    }
    if (depth > 0) {
        qos.history().depth = depth;
        qos.resource_limits().max_samples_per_instance = depth;
    }
}

} // namespace gridspace::bus
