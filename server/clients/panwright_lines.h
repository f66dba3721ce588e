/*
 * Client of `panwright serve --json-lines` on the same machine: one C89 file over POSIX sockets and
 * shared memory. GCC or Clang; a long has 64 bits.
 *
 *   #define PANWRIGHT_LINES_IMPLEMENTATION   in one source, before #include "panwright_lines.h"
 *
 *   pwl_client* server = pwl_open("127.0.0.1", 10363);       or pwl_open_path("/run/user/1000/pw")
 *   const pwl_layer* layer;
 *   pwl_image(server, "{\"camera\": [0, -10, 0], \"image\": \"shared\"}");
 *   layer = pwl_find(server, "radiance");                    layer->data: rows from the top
 *   if (!pwl_is_whole(server)) ...                           replaced by a later image meanwhile
 *   pwl_close(server);
 *
 * Functions return 0 for success; pwl_error() has the reason of the last failure, pwl_answer() the
 * whole line. docs/json-lines.md has the protocol, docs/views.md the members of a view.
 */
#ifndef PANWRIGHT_LINES_H
#define PANWRIGHT_LINES_H

#include <stddef.h>

#define PWL_MOST_LAYERS 16
enum { PWL_FLOAT32 = 0, PWL_UINT32 = 1, PWL_UINT16 = 2 };

typedef struct pwl_client pwl_client;
typedef struct pwl_layer {
  char name[24];
  unsigned type; /* PWL_FLOAT32 ... */
  unsigned width, height, channels;
  const void* data; /* height * width * channels numbers */
} pwl_layer;

/* NULL: no connection. */
pwl_client* pwl_open(const char* address, int port);
pwl_client* pwl_open_path(const char* path);
void pwl_close(pwl_client* client);
const char* pwl_error(const pwl_client* client);

/* Sends a line, without its end, and reads the answer. */
int pwl_ask(pwl_client* client, const char* view);
const char* pwl_answer(const pwl_client* client);

/* Asks for an image with "image": "shared", and finds its layers. */
int pwl_image(pwl_client* client, const char* view);
/* A layer of the last image; NULL: none of that name. */
const pwl_layer* pwl_find(const pwl_client* client, const char* name);
/* Whether the last image is still there: to be asked after its use. */
int pwl_is_whole(const pwl_client* client);

#endif

#ifdef PANWRIGHT_LINES_IMPLEMENTATION

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

typedef struct pwl_header {
  char magic[8];
  unsigned slots, spare;
  unsigned long slot_bytes, first_slot, newest;
} pwl_header;

typedef struct pwl_shared_layer {
  char name[24];
  unsigned type, channels;
  unsigned long offset, bytes;
} pwl_shared_layer;

typedef struct pwl_slot {
  unsigned long sequence;
  unsigned width, height, layers, spare;
  pwl_shared_layer layer[PWL_MOST_LAYERS];
} pwl_slot;

struct pwl_client {
  int socket;
  char error[256];
  char* answer;
  size_t size, room;
  char segment[64];
  const unsigned char* memory;
  size_t bytes;
  unsigned long number;
  unsigned count;
  pwl_layer layers[PWL_MOST_LAYERS];
};

static int pwl_fail(pwl_client* client, const char* text) {
  strncpy(client->error, text, sizeof client->error - 1);
  client->error[sizeof client->error - 1] = '\0';
  return -1;
}

static pwl_client* pwl_connected(int socket, const struct sockaddr* to, socklen_t size) {
  pwl_client* client = (pwl_client*)calloc(1, sizeof *client);
  if (client == NULL || socket < 0 || connect(socket, to, size) != 0) {
    if (socket >= 0) close(socket);
    free(client);
    return NULL;
  }
  client->socket = socket;
  return client;
}

pwl_client* pwl_open(const char* address, int port) {
  struct sockaddr_in to;
  const int wire = socket(AF_INET, SOCK_STREAM, 0), one = 1;
  memset(&to, 0, sizeof to);
  to.sin_family = AF_INET;
  to.sin_port = htons((unsigned short)port);
  to.sin_addr.s_addr = inet_addr(address);
  setsockopt(wire, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  return pwl_connected(wire, (const struct sockaddr*)&to, sizeof to);
}

pwl_client* pwl_open_path(const char* path) {
  struct sockaddr_un to;
  memset(&to, 0, sizeof to);
  to.sun_family = AF_UNIX;
  if (strlen(path) >= sizeof to.sun_path) return NULL;
  strcpy(to.sun_path, path);
  return pwl_connected(socket(AF_UNIX, SOCK_STREAM, 0), (const struct sockaddr*)&to, sizeof to);
}

static void pwl_unmap(pwl_client* client) {
  if (client->memory != NULL) munmap((void*)client->memory, client->bytes);
  client->memory = NULL;
  client->count = 0;
  client->segment[0] = '\0';
}

void pwl_close(pwl_client* client) {
  if (client == NULL) return;
  pwl_unmap(client);
  close(client->socket);
  free(client->answer);
  free(client);
}

const char* pwl_error(const pwl_client* client) { return client->error; }
const char* pwl_answer(const pwl_client* client) {
  return client->answer != NULL ? client->answer : "";
}

static int pwl_send(pwl_client* client, const char* from, size_t count) {
  while (count > 0) {
    const ssize_t sent = send(client->socket, from, count, MSG_NOSIGNAL);
    if (sent <= 0) return pwl_fail(client, "the server closed the connection");
    from += sent;
    count -= (size_t)sent;
  }
  return 0;
}

int pwl_ask(pwl_client* client, const char* view) {
  if (strchr(view, '\n') != NULL) return pwl_fail(client, "a view has one line");
  if (pwl_send(client, view, strlen(view)) != 0 || pwl_send(client, "\n", 1) != 0) return -1;
  client->size = 0;
  for (;;) {
    ssize_t got;
    if (client->room - client->size < 4096) {
      char* more = (char*)realloc(client->answer, 2 * client->room + 65536);
      if (more == NULL) return pwl_fail(client, "no memory");
      client->answer = more;
      client->room = 2 * client->room + 65536;
    }
    got = recv(client->socket, client->answer + client->size, client->room - client->size - 1, 0);
    if (got <= 0) {
      /* the name of memory whose server was killed */
      if (client->segment[0] != '\0') shm_unlink(client->segment);
      return pwl_fail(client, "the server closed the connection");
    }
    client->size += (size_t)got;
    if (client->answer[client->size - 1] != '\n') continue;
    client->answer[client->size - 1] = '\0';
    return 0;
  }
}

static int pwl_map(pwl_client* client, const char* name) {
  struct stat info;
  void* memory;
  const pwl_header* header;
  const int file = shm_open(name, O_RDONLY, 0);
  if (file < 0) return pwl_fail(client, "the shared memory is not there: another machine?");
  pwl_unmap(client);
  if (fstat(file, &info) != 0 || (size_t)info.st_size < sizeof(pwl_header)) {
    close(file);
    return pwl_fail(client, "the shared memory is too small");
  }
  memory = mmap(NULL, (size_t)info.st_size, PROT_READ, MAP_SHARED, file, 0);
  close(file);
  if (memory == MAP_FAILED) return pwl_fail(client, "the shared memory cannot be mapped");
  client->memory = (const unsigned char*)memory;
  client->bytes = (size_t)info.st_size;
  header = (const pwl_header*)memory;
  if (memcmp(header->magic, "PWIMAGE1", 8) != 0 || header->slots == 0 ||
      header->slot_bytes < sizeof(pwl_slot) || header->first_slot > client->bytes ||
      header->slot_bytes > (client->bytes - header->first_slot) / header->slots) {
    pwl_unmap(client);
    return pwl_fail(client, "the shared memory holds no images");
  }
  strcpy(client->segment, name);
  return 0;
}

static const pwl_slot* pwl_slot_of(const pwl_client* client) {
  const pwl_header* header = (const pwl_header*)client->memory;
  return (const pwl_slot*)(client->memory + header->first_slot +
                           client->number % header->slots * header->slot_bytes);
}

int pwl_is_whole(const pwl_client* client) {
  if (client->memory == NULL) return 0;
  /* what was read before stays before */
  __atomic_thread_fence(__ATOMIC_ACQUIRE);
  return __atomic_load_n(&pwl_slot_of(client)->sequence, __ATOMIC_RELAXED) == 2 * client->number;
}

static int pwl_find_layers(pwl_client* client) {
  const pwl_slot* slot = pwl_slot_of(client);
  const unsigned long slot_bytes = ((const pwl_header*)client->memory)->slot_bytes;
  unsigned i;
  client->count = 0;
  if (__atomic_load_n(&slot->sequence, __ATOMIC_ACQUIRE) != 2 * client->number)
    return pwl_fail(client, "the image is gone");
  for (i = 0; i < slot->layers && i < PWL_MOST_LAYERS; ++i) {
    const pwl_shared_layer from = slot->layer[i];
    pwl_layer* to = &client->layers[i];
    memcpy(to->name, from.name, sizeof to->name);
    to->name[sizeof to->name - 1] = '\0';
    to->type = from.type;
    to->channels = from.channels;
    to->width = slot->width;
    to->height = slot->height;
    to->data = (const unsigned char*)slot + from.offset;
    if (from.offset > slot_bytes || from.bytes > slot_bytes - from.offset ||
        from.bytes != (unsigned long)to->width * to->height * to->channels *
                          (from.type == PWL_UINT16 ? 2 : 4))
      return pwl_fail(client, "the image was replaced meanwhile");
    client->count = i + 1;
  }
  if (!pwl_is_whole(client)) return pwl_fail(client, "the image was replaced meanwhile");
  return 0;
}

int pwl_image(pwl_client* client, const char* view) {
  const char* shared;
  const char* end;
  char name[64];
  if (pwl_ask(client, view) != 0) return -1;
  shared = strstr(client->answer, "\"shared\":{\"name\":\"");
  if (shared == NULL) {
    const char* message = strstr(client->answer, "\"message\":\"");
    return pwl_fail(client, message != NULL ? message + 11 : "the answer has no image");
  }
  shared += 18;
  end = strchr(shared, '"');
  if (end == NULL || (size_t)(end - shared) >= sizeof name ||
      strncmp(end, "\",\"number\":", 11) != 0)
    return pwl_fail(client, "the answer has another form");
  memcpy(name, shared, (size_t)(end - shared));
  name[end - shared] = '\0';
  client->number = strtoul(end + 11, NULL, 10);
  if (strcmp(name, client->segment) != 0 && pwl_map(client, name) != 0) return -1;
  return pwl_find_layers(client);
}

const pwl_layer* pwl_find(const pwl_client* client, const char* name) {
  unsigned i;
  for (i = 0; i < client->count; ++i)
    if (strcmp(client->layers[i].name, name) == 0) return &client->layers[i];
  return NULL;
}

#endif
