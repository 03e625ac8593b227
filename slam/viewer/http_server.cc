#include "slam/viewer/http_server.h"

#include <array>
#include <atomic>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

#include <libwebsockets.h>
#include <unistd.h>

#include "slam/viewer/listen_address.h"
#include "slam/viewer/request_check.h"
#include "slam/viewer/response_body.h"
#include <orb360/nn/base/check.h>

namespace orb360 {
namespace {

constexpr size_t kPieceBytes = size_t{64} << 10;  // of a body, sent at once
constexpr int kMaxConnections = 64;
constexpr int kHeaderSeconds = 5;
constexpr int kIdleSeconds = 60;     // between requests of a connection
constexpr int kStalledSeconds = 30;  // for a reader that takes no byte

/// Sent with every response. The page loads from its own server only; styles and images that it
/// makes itself are data or blobs.
constexpr std::array<std::pair<const char*, const char*>, 6> kHeaders = {{
    {"content-security-policy:",
     "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' "
     "data: "
     "blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"x-content-type-options:", "nosniff"},
    {"referrer-policy:", "no-referrer"},
    {"cross-origin-resource-policy:", "same-origin"},
    {"cross-origin-opener-policy:", "same-origin"},
    {"cache-control:", "no-store"},
}};

/// What libwebsockets allocates, filled with zeros, for each connection.
struct Session {
  ResponseBody* body;
};

std::string HeaderOf(lws* connection, lws_token_indexes token) {
  const int length = lws_hdr_total_length(connection, token);
  if (length <= 0) return {};
  std::string value(static_cast<size_t>(length) + 1, '\0');
  if (lws_hdr_copy(connection, value.data(), length + 1, token) < 0) return {};
  value.resize(static_cast<size_t>(length));
  return value;
}

std::string CustomHeaderOf(lws* connection, const std::string& name) {
  const int name_length = static_cast<int>(name.size());
  const int length = lws_hdr_custom_length(connection, name.c_str(), name_length);
  if (length <= 0) return {};
  std::string value(static_cast<size_t>(length) + 1, '\0');
  if (lws_hdr_custom_copy(connection, value.data(), length + 1, name.c_str(), name_length) < 0) {
    return {};
  }
  value.resize(static_cast<size_t>(length));
  return value;
}

/// Ends a response. Returns what the callback has to: -1 closes the connection.
int Complete(lws* connection) { return lws_http_transaction_completed(connection) != 0 ? -1 : 0; }

bool AddHeader(lws* connection, const char* name, std::string_view value, unsigned char** at,
               unsigned char* end) {
  return lws_add_http_header_by_name(connection, reinterpret_cast<const unsigned char*>(name),
                                     reinterpret_cast<const unsigned char*>(value.data()),
                                     static_cast<int>(value.size()), at, end) == 0;
}

/// Writes status and headers. False where they do not fit or the connection is gone.
bool WriteHead(lws* connection, const Response& response) {
  std::array<unsigned char, LWS_PRE + 2048> buffer{};
  unsigned char* const begin = buffer.data() + LWS_PRE;
  unsigned char* const end = buffer.data() + buffer.size() - 1;
  unsigned char* at = begin;
  const auto status = static_cast<unsigned>(response.status);
  bool is_good = lws_add_http_common_headers(connection, status, response.type.c_str(),
                                             response.body->left(), &at, end) == 0;
  for (const auto& [name, value] : kHeaders) {
    is_good = is_good && AddHeader(connection, name, value, &at, end);
  }
  is_good = is_good && AddHeader(connection, "accept-ranges:", "bytes", &at, end);
  if (!response.content_range.empty()) {
    is_good = is_good && AddHeader(connection, "content-range:", response.content_range, &at, end);
  }
  return is_good && lws_finalize_write_http_header(connection, begin, &at, end) == 0;
}

/// Sends the next piece of a body.
int WritePiece(lws* connection, Session* session) {
  if (session->body == nullptr) return 0;
  std::array<char, LWS_PRE + kPieceBytes> buffer;
  const std::span<char> piece(buffer.data() + LWS_PRE, kPieceBytes);
  const std::optional<size_t> count = session->body->Read(piece);
  if (!count) return -1;
  const bool is_last = session->body->left() == 0;
  const int written = lws_write(connection, reinterpret_cast<unsigned char*>(piece.data()), *count,
                                is_last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP);
  if (written < static_cast<int>(*count)) return -1;
  if (is_last) {
    delete std::exchange(session->body, nullptr);
    return Complete(connection);
  }
  lws_set_timeout(connection, PENDING_TIMEOUT_HTTP_CONTENT, kStalledSeconds);
  lws_callback_on_writable(connection);
  return 0;
}

}  // namespace

class HttpServer::Impl {
 public:
  Impl(ResourceTable resources, const HttpAddress& address) : resources_(std::move(resources)) {
    RequireFree(address.address, address.port, address.port_option);
    lws_set_log_level(0, nullptr);
    address_ = address.address == "localhost" ? "127.0.0.1" : address.address;
    const bool is_ipv6 = address_.find(':') != std::string::npos;
    const bool is_any = address_ == "0.0.0.0" || address_ == "::";
    lws_context_creation_info info{};
    info.port = address.port;
    info.iface = is_any ? nullptr : address_.c_str();
    info.protocols = protocols_.data();
    info.user = this;
    info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
                   LWS_SERVER_OPTION_SKIP_SERVER_CANONICAL_NAME;
    if (!is_ipv6) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
    info.timeout_secs = kHeaderSeconds;
    info.timeout_secs_ah_idle = kHeaderSeconds;
    info.keepalive_timeout = kIdleSeconds;
    info.max_http_header_pool = kMaxConnections;
    info.fd_limit_per_thread = kMaxConnections + 4;  // the listening socket and the pipe to wake it
    info.vhost_name = "orb360";
    info.server_string = "orb360";
    context_ = lws_create_context(&info);
    lws_vhost* const vhost = context_ != nullptr ? lws_create_vhost(context_, &info) : nullptr;
    if (vhost == nullptr) {
      if (context_ != nullptr) lws_context_destroy(context_);
      throw UserError(HostAndPort(address_, address.port) +
                      ": cannot be listened at; choose another port with " + address.port_option);
    }
    port_ = lws_get_vhost_listen_port(vhost);
    rules_ = MakeAccessRules(address_, port_);
    thread_ = std::thread([this] {
      while (!is_ending_ && lws_service(context_, 0) >= 0) {
      }
    });
  }

  ~Impl() {
    is_ending_ = true;
    lws_cancel_service(context_);
    thread_.join();
    lws_context_destroy(context_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  int port() const { return port_; }

  std::string url() const {
    std::string address = address_;
    if (address == "0.0.0.0" || address == "::") {
      std::array<char, 256> name{};
      address = gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
    }
    std::string url = "http://" + HostAndPort(address, port_) + "/";
    if (!rules_.token.empty()) url += rules_.token + "/";
    return url;
  }

 private:
  static int Callback(lws* connection, lws_callback_reasons reason, void* user, void* in,
                      size_t length) {
    auto* const session = static_cast<Session*>(user);
    switch (reason) {
      case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        return -1;  // There is nothing to upgrade to.
      case LWS_CALLBACK_HTTP: {
        auto* const server = static_cast<Impl*>(lws_context_user(lws_get_context(connection)));
        return server->Answer(connection, session, {static_cast<const char*>(in), length});
      }
      case LWS_CALLBACK_HTTP_WRITEABLE:
        return WritePiece(connection, session);
      case LWS_CALLBACK_CLOSED_HTTP:
        if (session != nullptr) delete std::exchange(session->body, nullptr);
        return 0;
      default:
        return 0;
    }
  }

  int Answer(lws* connection, Session* session, std::string_view path) const {
    RequestHead head;
    char* uri = nullptr;
    int uri_length = 0;
    const int method = lws_http_get_uri_and_method(connection, &uri, &uri_length);
    const bool is_head = method == LWSHUMETH_HEAD;
    head.is_get = method == LWSHUMETH_GET || is_head;
    head.is_post = method == LWSHUMETH_POST;
    head.path = path;
    head.host = HeaderOf(connection, WSI_TOKEN_HOST);
    head.origin = HeaderOf(connection, WSI_TOKEN_ORIGIN);
    head.fetch_site = CustomHeaderOf(connection, "sec-fetch-site:");
    head.content_length = HeaderOf(connection, WSI_TOKEN_HTTP_CONTENT_LENGTH);
    const bool has_coding = lws_hdr_total_length(connection, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0;
    if (has_coding) head.content_length = "unknown";
    const Admission admission = CheckRequest(head, rules_);
    const std::string query = HeaderOf(connection, WSI_TOKEN_HTTP_URI_ARGS);
    const std::string range = HeaderOf(connection, WSI_TOKEN_HTTP_RANGE);
    Response response =
        admission.status == 200
            ? MakeResponse(resources_, {admission.resource, query, range, head.is_post})
            : TextResponse(admission.status, "refused");
    if (!WriteHead(connection, response)) return -1;
    // What follows a refused request may be its body.
    if (admission.status == 405 || admission.status == 413) return -1;
    if (is_head || response.body->left() == 0) return Complete(connection);
    delete std::exchange(session->body, new ResponseBody(*std::move(response.body)));
    lws_set_timeout(connection, PENDING_TIMEOUT_HTTP_CONTENT, kStalledSeconds);
    lws_callback_on_writable(connection);
    return 0;
  }

  const ResourceTable resources_;
  std::string address_;
  int port_ = 0;
  AccessRules rules_;
  const std::array<lws_protocols, 2> protocols_{
      {{"http", &Impl::Callback, sizeof(Session), 0, 0, nullptr, 0}, {}}};
  lws_context* context_ = nullptr;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

HttpServer::HttpServer(ResourceTable resources, const HttpAddress& address)
    : impl_(std::make_unique<Impl>(std::move(resources), address)) {}
HttpServer::~HttpServer() = default;
int HttpServer::port() const { return impl_->port(); }
std::string HttpServer::url() const { return impl_->url(); }

}  // namespace orb360
