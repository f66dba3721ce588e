% Client of `panwright serve` for Octave with the package sockets: a session as a struct of functions.
%
%   server = panwright_client ("127.0.0.1", 10363);
%   server.set_viewpoint ([0 0 14], [0 1 0 0]);
%   image = server.image ();                       % H x W x 3, 0 to 255
%   server.close ();
%
% Metres, radians; world_from_camera quaternions w x y z, camera x right, y down, z forward. docs/server-protocol.md
function server = panwright_client (address, port)
  pkg load sockets
  wire = socket (AF_INET, SOCK_STREAM, 0);
  if connect (wire, struct ("addr", address, "port", port)) != 0
    error ("panwright_client: no server at %s:%d", address, port);
  endif
  send (wire, word (hex2dec ("114")));
  expect (wire, 0);
  server.set_viewpoint = @(position, quaternion) command (wire, 269, doubles ([position, quaternion]));
  server.set_field_of_view = @(radians) command (wire, 279, floats (radians));
  server.set_sun = @(azimuth, elevation) command (wire, 280, doubles ([149597870700, azimuth, elevation]));
  server.set_object = @(number, position, quaternion) command (wire, 270, [word(number), doubles([position, quaternion])]);
  server.image = @() get_image (wire);
  server.point = @(x, y) get_point (wire, x, y);
  server.pulse = @(position, direction) get_pulse (wire, position, direction);
  server.close = @() leave (wire);
endfunction

function bytes = word (value)
  bytes = fliplr (typecast (uint32 (value), "uint8"));
endfunction

% The IEEE words, turned left by 9 bits.
function bytes = floats (values)
  bytes = uint8 ([]);
  for value = values
    bits = uint64 (typecast (single (value), "uint32"));
    bits = bitshift (bits, 9);
    bytes = [bytes, word(bitand (bits, uint64 (4294967295)) + bitshift (bits, -32))];
  endfor
endfunction

% Both IEEE words, turned left by 12 bits together, the low one first.
function bytes = doubles (values)
  bytes = uint8 ([]);
  for value = values
    halves = uint64 (typecast (double (value), "uint32"));
    least = bitand (bitshift (halves(1), 12), uint64 (4294967295)) + bitshift (halves(2), -20);
    most = bitand (bitshift (halves(2), 12), uint64 (4294967295)) + bitshift (halves(1), -20);
    bytes = [bytes, word(least), word(most)];
  endfor
endfunction

function bytes = get_bytes (wire, count)
  bytes = zeros (1, count, "uint8");
  at = 0;
  while at < count
    [part, got] = recv (wire, min (count - at, 65536));
    if got <= 0
      error ("panwright_client: the server closed the connection");
    endif
    bytes(at + (1:got)) = part(1:got);
    at += got;
  endwhile
endfunction

function value = get_word (wire)
  value = double (typecast (fliplr (get_bytes (wire, 4)), "uint32"));
endfunction

function value = get_float (wire)
  bits = uint64 (get_word (wire));
  bits = bitshift (bits, -9) + bitshift (bitand (bits, uint64 (511)), 23);
  value = double (typecast (uint32 (bits), "single"));
endfunction

function expect (wire, code)
  got = get_word (wire);
  if got == 1
    number = get_word (wire);
    lengths = double (get_bytes (wire, 2));
    error ("panwright_client: %s (%d)", char (get_bytes (wire, lengths(1) * 256 + lengths(2))), number);
  elseif got != code
    error ("panwright_client: reply %d, expected %d", got, code);
  endif
endfunction

function ask (wire, number, fields, code)
  send (wire, [word(number), fields]);
  expect (wire, code);
endfunction

function command (wire, number, fields)
  ask (wire, number, fields, 0);
endfunction

% A binary PPM or PGM of 8 bits.
function image = get_image (wire)
  ask (wire, 1, uint8 ([]), 2);
  bytes = get_bytes (wire, get_word (wire));
  header = sscanf (char (bytes(3:min (end, 40))), "%d", 3);
  channels = 1 + 2 * (bytes(2) == uint8 ("6"));
  pixels = bytes(end - header(1) * header(2) * channels + 1:end);
  image = permute (reshape (pixels, [channels, header(1), header(2)]), [3, 2, 1]);
endfunction

% The world point under an image place, from (0, 0) lower left to (1, 1) upper right; empty: nothing is there.
function point = get_point (wire, x, y)
  ask (wire, 4, floats ([x, y]), 5);
  point = [get_float(wire), get_float(wire), get_float(wire)];
  if get_bytes (wire, 1) == 0
    point = [];
  endif
endfunction

function [range, cosine] = get_pulse (wire, position, direction)
  ask (wire, 13, floats ([position, direction]), 9);
  range = get_float (wire);
  cosine = get_float (wire);
endfunction

function leave (wire)
  send (wire, word (0));
  disconnect (wire);
endfunction
