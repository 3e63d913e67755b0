/* Preloaded into a program: its FAIL_AT-th call that writes to a file (FAIL_AT from 1 on) fails with FAIL_WITH, an
   errno (default: no space left), and with FAIL_ON all that follow, too, as on a full disk. FAIL_NOTE names a file that
   is made when the first one fails. Standard streams are left alone. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static int number(const char* name, int otherwise) {
  const char* text = getenv(name);
  return text != NULL ? atoi(text) : otherwise;
}

static int fails(void) {
  static int calls = 0;
  const int at = number("FAIL_AT", 0);
  ++calls;
  if (at == 0 || calls < at || (calls > at && !number("FAIL_ON", 0))) return 0;
  if (calls == at && getenv("FAIL_NOTE") != NULL) {
    const int note = open(getenv("FAIL_NOTE"), O_WRONLY | O_CREAT, 0644);
    if (note >= 0) ((int (*)(int))dlsym(RTLD_NEXT, "close"))(note);
  }
  errno = number("FAIL_WITH", ENOSPC);
  return 1;
}

/* Not what threads and processes say to each other. */
static int is_file(int file) {
  struct stat status;
  return fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int file, const void* bytes, size_t count) {
  return file > 2 && is_file(file) && fails() ? -1 : NEXT(write)(file, bytes, count);
}
ssize_t pwrite(int file, const void* bytes, size_t count, off_t at) {
  return fails() ? -1 : NEXT(pwrite)(file, bytes, count, at);
}
ssize_t pwrite64(int file, const void* bytes, size_t count, off64_t at) {
  return fails() ? -1 : NEXT(pwrite64)(file, bytes, count, at);
}
int ftruncate(int file, off_t length) { return fails() ? -1 : NEXT(ftruncate)(file, length); }
int ftruncate64(int file, off64_t length) { return fails() ? -1 : NEXT(ftruncate64)(file, length); }
int fsync(int file) { return fails() ? -1 : NEXT(fsync)(file); }
int rename(const char* from, const char* to) { return fails() ? -1 : NEXT(rename)(from, to); }
int linkat(int from_folder, const char* from, int to_folder, const char* to, int flags) {
  return fails() ? -1 : NEXT(linkat)(from_folder, from, to_folder, to, flags);
}

/* The last word of a network file system or a quota: the file is closed nevertheless. */
int close(int file) {
  const int file_of_ours = file > 2 && is_file(file) && (fcntl(file, F_GETFL) & O_ACCMODE) != O_RDONLY;
  const int closed = NEXT(close)(file);
  return file_of_ours && number("FAIL_CLOSE", 0) && fails() ? -1 : closed;
}
