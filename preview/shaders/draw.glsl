// What is known of an instance in one view and tile, formed in double and rounded once. Defined in
// front: uniforms.glsl; INSTANCED where instances of one mesh and material are drawn at once; VERTEX.
#ifdef INSTANCED
layout(std140, binding = kDrawBinding) uniform Draws { DrawData draws[kInstancesAtOnce]; };
#ifdef VERTEX
layout(location = 10) flat out int draw_index;
#define draw draws[gl_InstanceID]
#else
layout(location = 10) flat in int draw_index;
#define draw draws[draw_index]
#endif
#else
layout(std140, binding = kDrawBinding) uniform Draw { DrawData draw; };
#endif
VIEW_BLOCK
