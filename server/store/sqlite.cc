#include "store/sqlite.h"

#include <sqlite3.h>

#include <cstdint>
#include <filesystem>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status.h"

namespace thunderhead::store {
namespace {

// The time in ms for which a write waits for a lock, for example of a backup that reads the file
// while the server runs.
constexpr int kBusyTimeoutMs = 2000;

// Returns the path with the symbolic links in its folder resolved. SQLite (SQLITE_OPEN_NOFOLLOW)
// refuses a path with any link, so it now refuses only a link in place of the file itself.
std::string PathInFolder(const std::string& path) {
  const std::filesystem::path file(path);
  std::error_code error;
  const auto folder = std::filesystem::canonical(
      file.has_parent_path() ? file.parent_path() : std::filesystem::path("."), error);
  return error ? path : (folder / file.filename()).string();
}

// Returns true if the disk has too little space for SQLite's own files.
bool IsOnFullDisk(const std::string& path) {
  constexpr std::uintmax_t kJournalBytes = 64 << 10;
  std::error_code error;
  const auto space = std::filesystem::space(std::filesystem::path(path).parent_path(), error);
  return !error && space.available < kJournalBytes;
}

}  // namespace

absl::Status DamagedFile(const std::string& path, const std::string& why) {
  return absl::DataLossError(absl::StrCat(
      path, " is damaged (", why, "); move it away, with ", path, "-journal and ", path,
      "-wal if they are there, to begin without sessions, or put a backup in its place; then start "
      "the server again"));
}

void Database::Close::operator()(sqlite3* database) const { sqlite3_close(database); }

absl::StatusOr<Database> Database::Open(const std::string& path) {
  Database database(path);
  sqlite3* handle = nullptr;
  const std::string file = path == kInMemory ? path : PathInFolder(path);
  const int code =
      sqlite3_open_v2(file.c_str(), &handle, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOFOLLOW, nullptr);
  database.handle_.reset(handle);
  if (code != SQLITE_OK) return database.Error();
  sqlite3_busy_timeout(handle, kBusyTimeoutMs);
  return database;
}

absl::Status Database::Execute(const std::string& sql) {
  const int code = sqlite3_exec(handle_.get(), sql.c_str(), nullptr, nullptr, nullptr);
  return code == SQLITE_OK ? absl::OkStatus() : Error();
}

absl::StatusOr<Statement> Database::Prepare(const std::string& sql) {
  sqlite3_stmt* handle = nullptr;
  const int code = sqlite3_prepare_v2(handle_.get(), sql.c_str(), -1, &handle, nullptr);
  if (code != SQLITE_OK) return Error();
  return Statement(*this, handle);
}

absl::StatusOr<std::int64_t> Database::Number(const std::string& sql) {
  THUNDERHEAD_ASSIGN_OR_RETURN(Statement query, Prepare(sql));
  THUNDERHEAD_ASSIGN_OR_RETURN(const bool found, query.Next());
  return found ? query.Number(0) : 0;
}

absl::Status Database::Error() const {
  const int code = sqlite3_errcode(handle_.get());
  const char* const message = sqlite3_errmsg(handle_.get());
  // SQLite reports SQL that does not match the tables, for example a missing one, as SQLITE_ERROR.
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT || code == SQLITE_ERROR) {
    return DamagedFile(path_, message);
  }
  return absl::UnavailableError(
      absl::StrCat(path_, " cannot be used: ", message,
                   IsOnFullDisk(path_) ? "; its disk is full: free some space" : ""));
}

void Statement::Finalize::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

// The results of the bind functions are ignored. Binding fails only for a parameter that the SQL
// does not have, or for lack of memory. Next reports a lack of memory.
void Statement::Bind(int parameter, std::int64_t value) {
  sqlite3_bind_int64(handle_.get(), parameter, value);
}

void Statement::Bind(int parameter, double value) {
  sqlite3_bind_double(handle_.get(), parameter, value);
}

void Statement::BindNull(int parameter) { sqlite3_bind_null(handle_.get(), parameter); }

void Statement::Bind(int parameter, std::string_view text) {
  sqlite3_bind_text64(handle_.get(), parameter, text.data(), text.size(), SQLITE_STATIC,
                      SQLITE_UTF8);
}

void Statement::BindBlob(int parameter, std::string_view bytes) {
  // SQLite would store NULL for a blob with a null pointer.
  const char* const data = bytes.empty() ? "" : bytes.data();
  sqlite3_bind_blob64(handle_.get(), parameter, data, bytes.size(), SQLITE_STATIC);
}

absl::Status Statement::Run() { return Next().status(); }

absl::StatusOr<bool> Statement::Next() {
  const int code = sqlite3_step(handle_.get());
  if (code == SQLITE_ROW) return true;
  absl::Status error;
  if (code != SQLITE_DONE) error = database_.Error();
  sqlite3_reset(handle_.get());
  if (!error.ok()) return error;
  return false;
}

bool Statement::IsNull(int column) const {
  return sqlite3_column_type(handle_.get(), column) == SQLITE_NULL;
}

double Statement::Real(int column) const { return sqlite3_column_double(handle_.get(), column); }

std::int64_t Statement::Number(int column) const {
  return sqlite3_column_int64(handle_.get(), column);
}

std::string Statement::Bytes(int column) const {
  const void* const data = sqlite3_column_blob(handle_.get(), column);
  const int size = sqlite3_column_bytes(handle_.get(), column);
  return data == nullptr ? "" : std::string(static_cast<const char*>(data), size);
}

absl::StatusOr<Transaction> Transaction::Begin(Database& database) {
  THUNDERHEAD_RETURN_IF_ERROR(database.Execute("BEGIN IMMEDIATE"));
  return Transaction(database);
}

Transaction::Transaction(Transaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

Transaction::~Transaction() {
  // The result is ignored, because SQLite may already have rolled back after an error.
  if (database_ != nullptr) (void)database_->Execute("ROLLBACK");
}

absl::Status Transaction::Commit() {
  THUNDERHEAD_RETURN_IF_ERROR(database_->Execute("COMMIT"));
  database_ = nullptr;
  return absl::OkStatus();
}

}  // namespace thunderhead::store
