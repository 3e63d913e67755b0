/* For the C programs here: the bytes of a model file. */
#ifndef READ_MODEL_H
#define READ_MODEL_H
#include <runtime/greenloop.h>
#include <stdio.h>
#include <stdlib.h>

/* The file, aligned as greenloop_open wants it, to be freed; exits if it cannot be read. */
static void* read_model(const char* path, size_t* size) {
  FILE* stream = fopen(path, "rb");
  if (stream == NULL || fseek(stream, 0, SEEK_END) != 0) exit(64);
  *size = (size_t)ftell(stream); /* a multiple of 64, as aligned_alloc asks */
  void* const memory = aligned_alloc(GREENLOOP_ALIGNMENT, *size);
  rewind(stream);
  if (memory == NULL || fread(memory, 1, *size, stream) != *size) exit(66);
  fclose(stream);
  return memory;
}

#endif
