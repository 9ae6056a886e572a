// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/check/gstcheck.h>

/// Memory that the CPU cannot map, as that of a GPU. It hides memory that it can.
class Unmappable
{
public:
  /// Takes the memory.
  static GstMemory *hide(GstMemory *hidden)
  {
    auto *memory = g_new0(Memory, 1);
    gst_memory_init(&memory->parent, GST_MEMORY_FLAG_NO_SHARE, allocator(), nullptr,
                    gst_memory_get_sizes(hidden, nullptr, nullptr), 0, 0,
                    gst_memory_get_sizes(hidden, nullptr, nullptr));
    memory->hidden = hidden;
    return &memory->parent;
  }
  /// The buffer with hidden memory. Takes the buffer.
  static GstBuffer *hide(GstBuffer *buffer)
  {
    return with_memory(buffer, hide(gst_buffer_get_all_memory(buffer)));
  }
  /// Such a buffer with the memory that is hidden in it. Takes the buffer.
  static GstBuffer *show(GstBuffer *buffer)
  {
    GstMemory *memory = gst_buffer_peek_memory(buffer, 0);
    fail_unless(memory->allocator == allocator());
    return with_memory(buffer, gst_memory_ref(reinterpret_cast<Memory *>(memory)->hidden));
  }

private:
  static GstBuffer *with_memory(GstBuffer *buffer, GstMemory *memory)
  {
    GstBuffer *result = gst_buffer_new();
    gst_buffer_copy_into(result, buffer, GST_BUFFER_COPY_METADATA, 0, static_cast<gsize>(-1));
    gst_buffer_append_memory(result, memory);
    gst_buffer_unref(buffer);
    return result;
  }
  struct Memory
  {
    GstMemory parent;
    GstMemory *hidden;
  };

  static GstAllocator *allocator()
  {
    static auto *one
        = static_cast<GstAllocator *>(gst_object_ref_sink(g_object_new(type(), nullptr)));
    return one;
  }
  static GType type()
  {
    static const GType type = g_type_register_static_simple(
        GST_TYPE_ALLOCATOR, "UnmappableAllocator", sizeof(GstAllocatorClass),
        [](gpointer klass, gpointer) {
          GST_ALLOCATOR_CLASS(klass)->free = [](GstAllocator *, GstMemory *memory) {
            gst_memory_unref(reinterpret_cast<Memory *>(memory)->hidden);
            g_free(memory);
          };
        },
        sizeof(GstAllocator),
        [](GTypeInstance *instance, gpointer) {
          auto *made = GST_ALLOCATOR(instance);
          made->mem_type = "Unmappable";
          made->mem_map = [](GstMemory *, gsize, GstMapFlags) -> gpointer {
            return nullptr;
          };
          made->mem_unmap = [](GstMemory *) {
          };
          GST_OBJECT_FLAG_SET(made, GST_ALLOCATOR_FLAG_CUSTOM_ALLOC);
        },
        GTypeFlags{});
    return type;
  }
};
