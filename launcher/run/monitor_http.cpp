// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_http.hpp"

#include "common/text.hpp"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace ssl = asio::ssl;
using boost::system::error_code;

/// An asynchronous operation, waited for: only such operations end when the stream's time is over.
template <class Start>
std::pair<error_code, std::size_t> wait(asio::io_context& context, Start const& start) {
    std::pair<error_code, std::size_t> out;
    start([&](error_code const& error, auto... size) { out = {error, (std::size_t{0} + ... + size)}; });
    context.restart();
    context.run();
    return out;
}

Result<asio::ip::tcp::endpoint> endpoint_of(std::string const& where) {
    std::size_t const colon = where.rfind(':');
    std::string const host = where.substr(0, colon);
    unsigned short port = 80;
    if (colon != std::string::npos) {
        std::from_chars(where.data() + colon + 1, where.data() + where.size(), port);
    }
    error_code error;
    auto const address =
        asio::ip::make_address_v4(host == "localhost" || host == "0.0.0.0" ? "127.0.0.1" : host, error);
    if (error) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an address", where), "for example 127.0.0.1:8080");
    }
    return asio::ip::tcp::endpoint{address, port};
}

/// Trusts the certificate itself, whoever has signed it.
Result<ssl::context> trusting(std::filesystem::path const& certificate) {
    ssl::context context{ssl::context::tls_client};
    error_code error;
    context.load_verify_file(certificate.string(), error);
    if (error) {
        return fail(ExitCode::environment,
                    fmt::format("cannot read the certificate '{}': {}", certificate.string(), error.message()));
    }
    ::SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    ::X509_VERIFY_PARAM_set_flags(::SSL_CTX_get0_param(context.native_handle()), X509_V_FLAG_PARTIAL_CHAIN);
    context.set_verify_mode(ssl::verify_peer);
    return context;
}

class Exchange {
  public:
    Exchange(MonitorAddress const& monitor, std::chrono::milliseconds patience)
        : monitor_{monitor}, patience_{patience} {}

    Result<MonitorReply> run(http::request<http::string_body> const& request) {
        auto const endpoint = endpoint_of(monitor_.address);
        if (!endpoint) {
            return std::unexpected{endpoint.error()};
        }
        beast::tcp_stream plain{context_};
        plain.expires_after(patience_);
        auto const [error, none] = wait(context_, [&](auto done) { plain.async_connect(*endpoint, done); });
        if (error) {
            return fail(ExitCode::environment,
                        fmt::format("no monitor answers at {}: {}", monitor_.address, error.message()),
                        "the run is over, or runs without a monitor");
        }
        if (monitor_.certificate.empty()) {
            return talk(plain, plain, request);
        }
        auto trust = trusting(monitor_.certificate);
        if (!trust) {
            return std::unexpected{trust.error()};
        }
        beast::ssl_stream<beast::tcp_stream> secured{std::move(plain), *trust};
        beast::get_lowest_layer(secured).expires_after(patience_);
        auto const [refused, nothing] =
            wait(context_, [&](auto done) { secured.async_handshake(ssl::stream_base::client, done); });
        if (refused == beast::error::timeout) {
            return silent(0);
        }
        if (refused) {
            return fail(ExitCode::environment, fmt::format("no TLS with the monitor: {}", refused.message()),
                        fmt::format("does it show the certificate '{}'?", monitor_.certificate.string()));
        }
        return talk(secured, beast::get_lowest_layer(secured), request);
    }

  private:
    template <class Stream>
    Result<MonitorReply> talk(Stream& stream, beast::tcp_stream& lowest,
                              http::request<http::string_body> const& request) {
        lowest.expires_after(patience_);
        if (auto const [error, size] = wait(context_, [&](auto done) { http::async_write(stream, request, done); });
            error && error != beast::error::timeout) {
            return fail(ExitCode::environment, "the monitor does not listen: " + error.message());
        }
        lowest.expires_after(patience_);
        beast::flat_buffer buffer;
        http::response_parser<http::string_body> parser;
        parser.body_limit(boost::none);
        auto const [error, parsed] = wait(context_, [&](auto done) { http::async_read(stream, buffer, parser, done); });
        std::size_t const octets = parsed + buffer.size();
        if (!error) {
            return MonitorReply{parser.get().result_int(), std::move(parser.get().body())};
        }
        if (error == beast::error::timeout) {
            return silent(octets);
        }
        bool const parsing = &error.category() == &make_error_code(http::error::end_of_stream).category();
        if (parsing && error != http::error::end_of_stream && error != http::error::partial_message) {
            return fail(ExitCode::environment, fmt::format("what answers at {} is not a monitor", monitor_.url()));
        }
        return fail(
            ExitCode::environment,
            octets == 0
                ? fmt::format("the monitor at {} has ended the connection without an answer", monitor_.url())
                : fmt::format("the answer of the monitor at {} was cut after {} octets", monitor_.url(), octets),
            "the run may just have ended: try again");
    }

    [[nodiscard]] std::unexpected<Error> silent(std::size_t octets) const {
        return fail(ExitCode::environment,
                    fmt::format("the monitor at {} has not answered within {} s{}", monitor_.url(),
                                shortest(std::chrono::duration<double>(patience_).count()),
                                octets == 0 ? "" : fmt::format(": {} octets of its answer came", octets)),
                    "its machine is very busy, or it is stopped: try again");
    }

    MonitorAddress const& monitor_;
    std::chrono::milliseconds patience_;
    asio::io_context context_;
};

} // namespace

Result<MonitorReply> exchange(MonitorAddress const& monitor, std::string_view method, std::string_view path,
                              std::string const& token, std::string content, std::chrono::milliseconds patience) {
    http::request<http::string_body> request;
    request.method_string({method.data(), method.size()});
    request.target({path.data(), path.size()});
    request.set(http::field::host, "localhost");
    request.keep_alive(false);
    if (!token.empty()) {
        request.set(http::field::authorization, "Bearer " + token);
    }
    if (!content.empty()) {
        request.set(http::field::content_type, "application/json");
        request.body() = std::move(content);
        request.prepare_payload();
    }
    return Exchange{monitor, patience}.run(request);
}

} // namespace gridspace::launcher
