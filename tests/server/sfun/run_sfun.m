% The S-function as Simulink calls it: set up, checked, started, several steps, ended. run_sfun.m CLIENTS PORT
words = argv ();
addpath (words{end - 1});
addpath (fileparts (mfilename ("fullpath")));
port = str2double (words{end});

function expect (condition, what)
  if ~condition
    error ("run_sfun: %s", what);
  end
end

function expect_error (call, text)
  try
    call ();
  catch problem
    expect (~isempty (strfind (problem.message, text)), ["another error: " problem.message]);
    return
  end
  error ("run_sfun: no error with '%s'", text);
end

function block = made (number, parameters)
  block = Block (number, parameters);
  panwright_sfun (block);
  expect (block.NumDialogPrms == 5, "five parameters");
  block.call ("CheckParameters");
end

function image = step (block, camera, objects)
  block.InputPort(1).Data = camera(:);
  if nargin > 2
    block.InputPort(2).Data = objects;
  end
  block.call ("Outputs");
  image = block.OutputPort(1).Data;
end

up = [0 1 0 0];
block = made (3.5, {"127.0.0.1", port, [48 64], 0.25, 1});
expect (isequal (block.SampleTimes, [0.25 0]), "a fixed step");
expect (block.NumInputPorts == 2 && isequal (block.InputPort(2).Dimensions, [7 1]), "ports of objects");
expect (isequal (block.OutputPort(1).Dimensions, [48 64 3]) && block.OutputPort(1).DatatypeID == 3, "an image comes out");
expect (block.InputPort(1).DirectFeedthrough, "of the camera that goes in at the same time");
other = made (4.5, {"127.0.0.1", port, [48 64], 0.25, 0});
expect (other.NumInputPorts == 1, "no port without objects");
block.call ("Start");
other.call ("Start");

% the same images as the client's, whichever block asks
server = panwright_client ("127.0.0.1", port);
rest = [0 0 0 1 0 0 0]';
for k = 0:3
  camera = [0.3 * k, 0, 14, up];
  server.set_viewpoint (camera(1:3), up);
  expected = server.image ();
  expect (isequal (size (expected), [48 64 3]) && isa (expected, "uint8"), "an image");
  expect (isequal (step (block, camera, rest), expected), "the image of the client");
  expect (isequal (step (other, camera), expected), "and of another block");
end
% an object that moves as the camera does stays where it is in the image
moved = step (block, [2 0 14 up], [2 0 0 1 0 0 0]');
still = step (block, [0 0 14 up], rest);
expect (max (abs (double (moved(:)) - double (still(:)))) <= 1, "an object moves");
expect (~isequal (still, step (block, [0 0 14 up], [2 0 0 1 0 0 0]')), "and is seen to");
% lengths near 1 are made 1
expect (isequal (step (block, [0 0 14 up * 1.0002], rest), still), "quaternions are made unit");
expect_error (@() step (block, [0 0 14 0 2 0 0], rest), "a quaternion has the length 2");

small = made (5.5, {"127.0.0.1", port, [10 10], 0.25, 0});
small.call ("Start");
expect_error (@() step (small, [0 0 14 up]), "the server sends images of [48 64 3], expected [10 10 3]");
for each = {block, other, small}
  each{1}.call ("Terminate");
  each{1}.call ("Terminate");  % Simulink may, after an error
end
server.close ();
expect_error (@() made (6, {"127.0.0.1", port, [48 64], 0, 0}), "the parameter step");
expect_error (@() made (6, {"127.0.0.1", 0, [48 64], 1, 0}), "the parameter port");
printf ("the S-function steps\n");
