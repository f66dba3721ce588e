/*
 * Client of `panwright serve` and other servers of the PANGU protocol: one C89 file over POSIX
 * sockets.
 *
 *   #define PANWRIGHT_CLIENT_IMPLEMENTATION   in one source, before #include "panwright_client.h"
 *
 *   pw_client* server = pw_open("127.0.0.1", PW_PORT);
 *   pw_set_viewpoint(server, position, quaternion);
 *   image = pw_image(server, &size);           free(image) afterwards
 *   pw_close(server);
 *
 * Metres, radians; world_from_camera quaternions w x y z, camera x right, y down, z forward.
 * Functions return 0 for success; pw_error() has the reason of the last failure. docs/server.md has
 * the protocol.
 */
#ifndef PANWRIGHT_CLIENT_H
#define PANWRIGHT_CLIENT_H

#include <stddef.h>

#define PW_PORT 10363

typedef struct pw_client pw_client;

/* NULL: no connection. */
pw_client* pw_open(const char* address, int port);
void pw_close(pw_client* client);
const char* pw_error(const pw_client* client);

int pw_set_viewpoint(pw_client* client, const double position[3], const double quaternion[4]);
int pw_set_field_of_view(pw_client* client, double radians);
int pw_set_object(pw_client* client, unsigned object, const double position[3],
                  const double quaternion[4]);
int pw_set_joint(pw_client* client, unsigned object, unsigned joint, const double* values,
                 unsigned count);
/* The distance in metres; 0: as it is. */
int pw_set_sun(pw_client* client, double distance, double azimuth, double elevation);

/* The bytes of an image file, from malloc(); NULL: failed. */
unsigned char* pw_image(pw_client* client, size_t* size);
/* The world point under an image place, from (0, 0) lower left to (1, 1) upper right; *hit 0:
 * nothing is there. */
int pw_point(pw_client* client, double x, double y, double point[3], int* hit);
/* Range along a ray, and the cosine of the incidence angle; 0 0: nothing is hit. */
int pw_pulse(pw_client* client, const double position[3], const double direction[3], double* range,
             double* cosine);

#endif

#ifdef PANWRIGHT_CLIENT_IMPLEMENTATION

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

struct pw_client {
  int socket;
  char error[256];
  unsigned char request[512];
  size_t size;
};

static int pw_fail(pw_client* client, const char* text) {
  strncpy(client->error, text, sizeof client->error - 1);
  client->error[sizeof client->error - 1] = '\0';
  return -1;
}

static void pw_add_word(pw_client* client, unsigned long word) {
  int shift;
  for (shift = 24; shift >= 0; shift -= 8)
    client->request[client->size++] = (unsigned char)(word >> shift & 0xFF);
}

static void pw_begin(pw_client* client, unsigned long number) {
  client->size = 0;
  pw_add_word(client, number);
}

/* The IEEE word, turned left by 9 bits. */
static void pw_add_float(pw_client* client, double value) {
  float single = (float)value;
  unsigned int word;
  memcpy(&word, &single, 4);
  pw_add_word(client, (unsigned int)(word << 9 | word >> 23));
}

/* Both IEEE words, turned left by 12 bits together, the low one first. */
static void pw_add_double(pw_client* client, double value) {
  unsigned int halves[2], low, high;
  const unsigned int one = 1;
  const int little = *(const unsigned char*)&one;
  memcpy(halves, &value, 8);
  low = halves[little ? 0 : 1];
  high = halves[little ? 1 : 0];
  pw_add_word(client, (unsigned int)(low << 12 | high >> 20));
  pw_add_word(client, (unsigned int)(high << 12 | low >> 20));
}

static void pw_add_doubles(pw_client* client, const double* values, int count) {
  int i;
  for (i = 0; i < count; ++i) pw_add_double(client, values[i]);
}

static int pw_read(pw_client* client, void* to, size_t count) {
  unsigned char* at = (unsigned char*)to;
  while (count > 0) {
    const ssize_t got = recv(client->socket, at, count, 0);
    if (got <= 0) return pw_fail(client, "the server closed the connection");
    at += got;
    count -= (size_t)got;
  }
  return 0;
}

static int pw_read_word(pw_client* client, unsigned long* word) {
  unsigned char bytes[4];
  if (pw_read(client, bytes, 4) != 0) return -1;
  *word = (unsigned long)bytes[0] << 24 | (unsigned long)bytes[1] << 16 |
          (unsigned long)bytes[2] << 8 | bytes[3];
  return 0;
}

static int pw_read_float(pw_client* client, double* value) {
  unsigned long word;
  unsigned int turned;
  float single;
  if (pw_read_word(client, &word) != 0) return -1;
  turned = (unsigned int)word;
  turned = turned >> 9 | turned << 23;
  memcpy(&single, &turned, 4);
  *value = single;
  return 0;
}

/* Sends the request and reads the code of its reply. */
static int pw_ask(pw_client* client, unsigned long expected) {
  size_t at = 0;
  unsigned long code, number;
  while (at < client->size) {
    const ssize_t sent =
        send(client->socket, client->request + at, client->size - at, MSG_NOSIGNAL);
    if (sent <= 0) return pw_fail(client, "the server closed the connection");
    at += (size_t)sent;
  }
  if (pw_read_word(client, &code) != 0) return -1;
  if (code == 1) {
    unsigned char length[2];
    char text[1024];
    size_t size;
    if (pw_read_word(client, &number) != 0 || pw_read(client, length, 2) != 0) return -1;
    size = (size_t)length[0] << 8 | length[1];
    if (size >= sizeof text || pw_read(client, text, size) != 0)
      return pw_fail(client, "an error reply is too long");
    text[size] = '\0';
    return pw_fail(client, text);
  }
  return code == expected ? 0 : pw_fail(client, "an unexpected reply");
}

pw_client* pw_open(const char* address, int port) {
  struct sockaddr_in to;
  const int on = 1;
  pw_client* client = (pw_client*)calloc(1, sizeof *client);
  if (client == NULL) return NULL;
  memset(&to, 0, sizeof to);
  to.sin_family = AF_INET;
  to.sin_port = htons((unsigned short)port);
  client->socket = socket(AF_INET, SOCK_STREAM, 0);
  if (client->socket >= 0 && inet_pton(AF_INET, address, &to.sin_addr) == 1 &&
      connect(client->socket, (struct sockaddr*)&to, sizeof to) == 0) {
    setsockopt(client->socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    pw_begin(client, 0x114);
    if (pw_ask(client, 0) == 0) return client;
  }
  if (client->socket >= 0) close(client->socket);
  free(client);
  return NULL;
}

void pw_close(pw_client* client) {
  if (client == NULL) return;
  pw_begin(client, 0);
  (void)send(client->socket, client->request, client->size, MSG_NOSIGNAL);
  close(client->socket);
  free(client);
}

const char* pw_error(const pw_client* client) { return client->error; }

int pw_set_viewpoint(pw_client* client, const double position[3], const double quaternion[4]) {
  pw_begin(client, 269);
  pw_add_doubles(client, position, 3);
  pw_add_doubles(client, quaternion, 4);
  return pw_ask(client, 0);
}

int pw_set_field_of_view(pw_client* client, double radians) {
  pw_begin(client, 279);
  pw_add_float(client, radians);
  return pw_ask(client, 0);
}

int pw_set_object(pw_client* client, unsigned object, const double position[3],
                  const double quaternion[4]) {
  pw_begin(client, 270);
  pw_add_word(client, object);
  pw_add_doubles(client, position, 3);
  pw_add_doubles(client, quaternion, 4);
  return pw_ask(client, 0);
}

int pw_set_joint(pw_client* client, unsigned object, unsigned joint, const double* values,
                 unsigned count) {
  unsigned i;
  pw_begin(client, 272);
  pw_add_word(client, object);
  pw_add_word(client, joint);
  pw_add_word(client, 9);
  for (i = 0; i < 9; ++i) {
    pw_add_double(client, i < count ? values[i] : 0.0);
    client->request[client->size++] = i < count;
  }
  return pw_ask(client, 0);
}

int pw_set_sun(pw_client* client, double distance, double azimuth, double elevation) {
  pw_begin(client, 280);
  pw_add_double(client, distance);
  pw_add_double(client, azimuth);
  pw_add_double(client, elevation);
  return pw_ask(client, 0);
}

unsigned char* pw_image(pw_client* client, size_t* size) {
  unsigned long count;
  unsigned char* bytes;
  pw_begin(client, 1);
  if (pw_ask(client, 2) != 0 || pw_read_word(client, &count) != 0) return NULL;
  bytes = (unsigned char*)malloc(count > 0 ? count : 1);
  if (bytes == NULL) {
    pw_fail(client, "no memory for the image");
    return NULL;
  }
  if (pw_read(client, bytes, count) != 0) {
    free(bytes);
    return NULL;
  }
  *size = count;
  return bytes;
}

int pw_point(pw_client* client, double x, double y, double point[3], int* hit) {
  unsigned char mark;
  int k;
  pw_begin(client, 4);
  pw_add_float(client, x);
  pw_add_float(client, y);
  if (pw_ask(client, 5) != 0) return -1;
  for (k = 0; k < 3; ++k)
    if (pw_read_float(client, &point[k]) != 0) return -1;
  if (pw_read(client, &mark, 1) != 0) return -1;
  *hit = mark != 0;
  return 0;
}

int pw_pulse(pw_client* client, const double position[3], const double direction[3], double* range,
             double* cosine) {
  int k;
  pw_begin(client, 13);
  for (k = 0; k < 3; ++k) pw_add_float(client, position[k]);
  for (k = 0; k < 3; ++k) pw_add_float(client, direction[k]);
  if (pw_ask(client, 9) != 0) return -1;
  return pw_read_float(client, range) != 0 ? -1 : pw_read_float(client, cosine);
}

#endif
