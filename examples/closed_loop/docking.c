/*
 * Steers a camera to a docking ring by what a server measures, as docking.py: `panwright serve
 * client.pxn`, then cc -std=c89 docking.c -lm -o docking && ./docking [PORT]
 */
#define _POSIX_C_SOURCE 200809L
#define _DEFAULT_SOURCE
#define PANWRIGHT_CLIENT_IMPLEMENTATION
#include "../../server/clients/panwright_client.h"

#include <math.h>

#define FOV (40 * 3.14159265358979323846 / 180)
#define END 3.0 /* metres above the surface */

/* Centre of brightness of a PPM, from (0, 0) lower left to (1, 1) upper right; 0: there is none. */
static int find_centre(const unsigned char* image, size_t size, double* x, double* y) {
  int width, height, most, column, row;
  double total = 0, along = 0, down = 0;
  const unsigned char* pixels;
  if (sscanf((const char*)image, "P6 %d %d %d", &width, &height, &most) != 3 || most != 255)
    return 0;
  pixels = image + size - (size_t)3 * width * height;
  for (row = 0; row < height; ++row)
    for (column = 0; column < width; ++column) {
      const double grey = pixels[3 * ((size_t)row * width + column) + 1];
      total += grey;
      along += grey * (column + 0.5);
      down += grey * (row + 0.5);
    }
  if (total <= 0) return 0;
  *x = along / total / width;
  *y = 1 - down / total / height;
  return 1;
}

int main(int count, char** words) {
  const double quaternion[4] = {0, 1, 0, 0};
  double position[3] = {2.0, -1.5, 14.0};
  int step, hit;
  pw_client* server = pw_open("127.0.0.1", count > 1 ? atoi(words[1]) : PW_PORT);
  if (server == NULL) {
    fprintf(stderr, "no server\n");
    return 1;
  }
  if (pw_set_field_of_view(server, FOV) != 0 || pw_set_sun(server, 0, 0, 1.5707963267948966) != 0)
    goto failed;
  for (step = 0; step < 40; ++step) {
    size_t size;
    unsigned char* image;
    double x, y, point[3], distance, aside[2], off;
    if (pw_set_viewpoint(server, position, quaternion) != 0) goto failed;
    image = pw_image(server, &size);
    if (image == NULL) goto failed;
    hit = find_centre(image, size, &x, &y);
    free(image);
    if (hit && pw_point(server, x, y, point, &hit) != 0) goto failed;
    if (!hit) break;
    distance = position[2] - point[2];
    aside[0] = (x - 0.5) * 2 * tan(FOV / 2) * distance;
    aside[1] = (y - 0.5) * 2 * tan(FOV / 2) * distance;
    off = sqrt(aside[0] * aside[0] + aside[1] * aside[1]);
    printf("step %d: %.3f m above the surface, %.3f m off its middle\n", step, distance, off);
    if (fabs(distance - END) < 0.05 && off < 0.02) {
      printf("docked at %.2f %.2f %.2f\n", position[0], position[1], position[2]);
      pw_close(server);
      return 0;
    }
    position[0] += aside[0] / 2;
    position[1] += aside[1] / 2;
    position[2] -= (distance - END) / 3;
  }
  fprintf(stderr, "the camera did not reach the ring\n");
  pw_close(server);
  return 1;
failed:
  fprintf(stderr, "%s\n", pw_error(server));
  pw_close(server);
  return 1;
}
