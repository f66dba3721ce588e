% Level-2 MATLAB S-function: a camera that `panwright serve` draws, in lock-step with a Simulink model.
%
% Parameters: address, port, [height width] of the images (--size of the server), seconds between images, number of objects that move.
% Inputs:  1  camera: position, world_from_camera quaternion w x y z (7)
%          2  objects, where their number is above 0: position and world_from_model quaternion of each (7 x number, object 0 first)
% Output:  1  image, uint8, height x width x 3
% A step waits for its image, so that a run is the same however fast it is. docs/server.md
function panwright_sfun (block)
  block.NumDialogPrms = 5;
  objects = block.DialogPrm(5).Data;
  block.NumInputPorts = 1 + (objects > 0);
  block.NumOutputPorts = 1;
  block.SetPreCompInpPortInfoToDynamic;
  block.SetPreCompOutPortInfoToDynamic;
  double_type = 0;
  uint8_type = 3;
  sizes = {7, [7 objects]};
  for k = 1:block.NumInputPorts
    block.InputPort(k).Dimensions = sizes{k};
    block.InputPort(k).DatatypeID = double_type;
    block.InputPort(k).Complexity = 'Real';
    block.InputPort(k).SamplingMode = 'Sample';
    block.InputPort(k).DirectFeedthrough = true;
  end
  block.OutputPort(1).Dimensions = [reshape(block.DialogPrm(3).Data, 1, 2), 3];
  block.OutputPort(1).DatatypeID = uint8_type;
  block.OutputPort(1).Complexity = 'Real';
  block.OutputPort(1).SamplingMode = 'Sample';
  block.SampleTimes = [block.DialogPrm(4).Data, 0];
  block.SimStateCompliance = 'DisallowSimState';  % the connection is no state that can be kept
  block.RegBlockMethod ('CheckParameters', @check);
  block.RegBlockMethod ('Start', @start);
  block.RegBlockMethod ('Outputs', @outputs);
  block.RegBlockMethod ('Terminate', @terminate);
end

function check (block)
  what = {'address', 'port', 'size', 'step', 'objects'};
  tests = {@ischar, @(p) isscalar (p) && p >= 1 && p <= 65535, @(s) numel (s) == 2 && all (s >= 1), @(t) isscalar (t) && t > 0, ...
           @(n) isscalar (n) && n >= 0 && n == floor (n)};
  for k = 1:5
    if ~tests{k} (block.DialogPrm(k).Data)
      error ('panwright_sfun: the parameter %s has no sense', what{k});
    end
  end
end

function start (block)
  server = panwright_client (block.DialogPrm(1).Data, block.DialogPrm(2).Data);
  sessions ('set', block.BlockHandle, server);
end

function outputs (block)
  server = sessions ('get', block.BlockHandle);
  camera = reshape (block.InputPort(1).Data, 1, 7);
  for number = 1:block.DialogPrm(5).Data
    object = reshape (block.InputPort(2).Data(:, number), 1, 7);
    server.set_object (number - 1, object(1:3), unit (object(4:7)));
  end
  server.set_viewpoint (camera(1:3), unit (camera(4:7)));
  image = server.image ();
  wanted = [reshape(block.DialogPrm(3).Data, 1, 2), 3];
  if ~isequal (size (image), wanted)
    error ('panwright_sfun: the server sends images of %s, expected %s; --size and --format ppm of the server', mat2str (size (image)), ...
           mat2str (wanted));
  end
  block.OutputPort(1).Data = image;
end

% Integrators leave quaternions a little long or short.
function q = unit (q)
  length = norm (q);
  if ~(abs (length - 1) < 1e-3)
    error ('panwright_sfun: a quaternion has the length %g', length);
  end
  q = q / length;
end

function terminate (block)
  server = sessions ('take', block.BlockHandle);
  if ~isempty (server)
    server.close ();
  end
end

% Connections by block: the handle of a block is a number that Simulink gives.
function server = sessions (what, block, server)
  persistent all
  if isempty (all)
    all = containers.Map ('KeyType', 'double', 'ValueType', 'any');
  end
  if strcmp (what, 'set')
    all(block) = server;
    return
  end
  server = [];
  if isKey (all, block)
    server = all(block);
  end
  if strcmp (what, 'take') && isKey (all, block)
    remove (all, block);
  end
end
