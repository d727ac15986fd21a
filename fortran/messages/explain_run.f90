!> Explanations of E05xx and above: what a run says.
module lopin_explain_run
   use lopin_explanation, only : explanation_type, add_explanation
   implicit none
   private
   public :: run_explanations

contains

   subroutine run_explanations(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call convergence(list)
      call singular_states(list)
      call theory_limits(list)
      call energies(list)
      call supports(list)
      call files(list)
      call parts(list)
      call usage(list)
   end subroutine run_explanations

   !> How an increment fails to converge.
   subroutine convergence(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0501', 'the contact states do not settle', &
         & 'Each change of the set of closed points lowers the energy, so that none comes '// &
         & 'back: what changes still is rounding of gaps and forces.', 'check the units, and '// &
         & 'stiffnesses of materials and contacts that differ by many orders.')
      call add_explanation(list, 'E0502', 'the multipliers have not settled', &
         & 'AUGMENTED LAGRANGE takes the load over pass by pass; with a slope far below the '// &
         & 'stiffness of the body each pass takes over little.', &
         & 'raise the slope or MAX AUGMENTATIONS=, or leave the slope out: it is then chosen.')
      call add_explanation(list, 'E0503', 'the step needs more increments', &
         & 'The step did not reach its end in the increments that INC= allows. Results up to '// &
         & 'there are kept.', &
         & 'raise INC= on *STEP, or take larger increments on *STATIC.')
      call add_explanation(list, 'E0504', 'the certificate of an increment fails', &
         & 'Every accepted increment is tested: no penetration, no tension, pressure only '// &
         & 'where the gap is '// &
         & 'closed, forces in equilibrium, action and reaction, energy, pressures that carry '// &
         & 'the forces. A test is above ten '// &
         & 'times its limit, '// &
         & 'so the answer cannot be trusted.', &
         & 'the message names the test. Penalty: a larger slope, or AUGMENTED LAGRANGE. '// &
         & 'Energy: smaller increments.')
      call add_explanation(list, 'W0504', 'the certificate of an increment warns', &
         & 'A test of the increment is above its limit but below ten times it; the message '// &
         & 'names the test.', &
         & 'with a penalty raise the slope, or use DIRECT or AUGMENTED LAGRANGE; where '// &
         & 'pressures do not carry the force, faces are too coarse for them (a pressure at the '// &
         & 'rim of contact is a mean that counts what is open beside it): refine there.')
      call add_explanation(list, 'E0505', 'a tool that forces move does not come to rest', &
         & 'A curved tool is projected where it stands, it moves, and is projected again; here '// &
         & 'the places go on changing.', &
         & 'prescribe its displacement, or take smaller increments.')
      call add_explanation(list, 'E0116', 'the path cannot solve this scene', &
         & 'The condensed path solves linear solids whose contacts slide little; the message '// &
         & 'says what of the scene is more than that.', &
         & 'leave out PATH= on *LOPIN: the path is then chosen.')
      call add_explanation(list, 'E0510', 'Newton has not converged', &
         & 'The finite path cuts an increment that does not converge; here it cannot be cut '// &
         & 'further (smallest increment, or DIRECT on *STATIC). Named are the dof farthest '// &
         & 'from '// &
         & 'balance and a contact that has changed in the last iteration, and how far the '// &
         & 'step came: look there (lopin report draws the last increment that was found).', &
         & 'the message says what suits the scene: let increments be cut; drive by '// &
         & 'displacement beyond a limit load; SMOOTH=YES or ELASTIC SLIP= where contacts '// &
         & 'change for ever.')
   end subroutine convergence

   !> Tangents, free bodies, and states of friction.
   subroutine singular_states(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0511', 'the tangent is singular', &
         & 'At the trial state a motion meets no resistance: a limit load under force control, '// &
         & 'or a part that nothing holds.', &
         & 'drive by displacement instead of force, or hold the part.')
      call add_explanation(list, 'N0511', 'a free body was held', &
         & 'Where nothing but contact still to come holds a body, an iteration of Newton '// &
         & 'stands on soft springs to the ground. They are in the matrix of that iteration '// &
         & 'only: the equilibrium that is accepted has none. On the linear path artificial '// &
         & 'supports hold such a body where it was as long as no load drives it; they carry '// &
         & 'nothing. What loads do on the way of such a body is energy.artificial (see W0532).', &
         & 'drive the body by displacement until it touches, to spare these iterations.')
      call add_explanation(list, 'E0512', 'an element would turn inside out', &
         & 'The determinant of the deformation gradient is not positive at an integration '// &
         & 'point of the named element, however short the step. In elements with I the '// &
         & 'internal modes may find no balance before that.', &
         & 'smaller increments, or a mesh that bears the strain.')
      call add_explanation(list, 'E0520', 'stick and slip cycle', &
         & 'The states of the points with friction change for ever between the same ones, with '// &
         & 'every cure that Lopin knows: the load in parts, a damped tangent, one row at '// &
         & 'a time, fixed bounds, coefficients that come down from where all sticks. '// &
         & 'Often no unique state exists: see W0520. A body that friction cannot hold as a '// &
         & 'whole is E0310; one that it hardly holds may cycle, too.', &
         & 'take smaller increments or ELASTIC SLIP=; a body that friction hardly holds '// &
         & 'needs more friction or a support.')
      call add_explanation(list, 'N0520', 'elastic slip of a penalty pair', &
         & 'A pair that lets penetrate also lets slip a little where it sticks: 0.5 % of the '// &
         & 'facet at the bound, unless ELASTIC SLIP, SLIP TOLERANCE or a stick slope is given.', &
         & 'give one of them on *FRICTION, or use DIRECT: it sticks exactly.')
      call add_explanation(list, 'W0520', 'frictional wedging', &
         & 'Coulomb friction beyond a critical coefficient has several equilibria: a node that '// &
         & 'slides presses itself on. Critical is K_tt/|K_nt| of the node''s own stiffness; '// &
         & 'near incompressibility and at sheared elements ordinary coefficients exceed it.', &
         & 'the answer is an equilibrium, the one that the load history leads to; judge it by '// &
         & 'another history, or refine the mesh there.')
      call add_explanation(list, 'W0521', 'friction under tension', &
         & 'NO SEPARATION holds a point that is pulled; the bound of friction is that of no '// &
         & 'pressure, so nothing holds it along the face.', &
         & 'use TIED or ROUGH where it should stick under tension too.')
      call add_explanation(list, 'E0521', 'the path newton has no friction', &
         & 'PATH=NEWTON is the literal system of contact without friction.', &
         & 'leave out PATH= on *LOPIN: friction is solved on the condensed or the finite path.')
      call add_explanation(list, 'W0314', 'a pair never closed', &
         & 'No point of the slave met the master in the whole run. The smallest gap is told.', &
         & 'look at units and positions; take the pair out if it is not needed.')
   end subroutine singular_states

   !> Where a theory or an increment ends.
   subroutine theory_limits(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0505', 'a node slides far on its facet', &
         & 'Contact is followed in small sliding: each slave node keeps the place and the '// &
         & 'normal '// &
         & 'on the master that it had at the start. Beyond a quarter of a facet this shows.', &
         & 'coarser slave facets, or another version of the scene that starts where it ends.')
      call add_explanation(list, 'W0506', 'an element turns much', &
         & 'Strains are linear in the displacements; a rotation t (in radians) is taken for a '// &
         & 'stretch of t^2/2, 0.1 % at 0.05.', &
         & 'hold rotations that are not meant; look at modulus and loads.')
      call add_explanation(list, 'W0507', 'an element is strained much', &
         & 'Stresses are linear in strains that are linear in displacements: beyond 5 % the '// &
         & 'answer differs from that of finite strains by as much. Every increment of a step '// &
         & 'is looked at; the largest strain is said at its end.', &
         & 'look at units, loads and modulus.')
      call add_explanation(list, 'W0513', 'a rigid body of nodes turns far', &
         & 'Without NLGEOM the nodes of *RIGID BODY, NSET= or ELSET= follow their reference '// &
         & 'node by linear equations, which hold for small rotations: turned by t they stand '// &
         & 'sqrt(1 + t^2) times too far out. With NLGEOM they go on circles.', &
         & 'NLGEOM on *STEP.')
      call add_explanation(list, 'E0513', 'more plastic flow than one increment follows', &
         & 'The return to the yield surface takes the direction of flow at the end of the '// &
         & 'increment. Where the strain of one increment is as large as here, the answer '// &
         & 'depends on it; increments that may be cut are.', &
         & 'smaller increments on *STATIC; DIRECT takes them as they are.')
      call add_explanation(list, 'E0514', 'a balance with an element inside out', &
         & 'Forces are in equilibrium, but the corner of an element has turned inside out that '// &
         & 'was far from it where the increment began: Newton has found a balance that the '// &
         & 'path does not lead to. Increments that may be cut are; E0504 ends the run where '// &
         & 'the path itself folds the mesh.', &
         & 'smaller increments on *STATIC.')
      call add_explanation(list, 'E0516', 'a balance with more energy than it was given', &
         & 'Forces are in equilibrium, but the bodies store and dissipate well more than '// &
         & 'the work that loads, supports and tools can have done in the increment: Newton has '// &
         & 'leapt to an equilibrium that the path does not lead to, as a crease in a free '// &
         & 'surface. Increments that may be cut are; where they may not, W0530 tells it.', &
         & 'smaller increments on *STATIC; a finer mesh where the surface creases.')
      call add_explanation(list, 'E0515', 'a first increment that flows too far', &
         & 'Without a first datum on *STATIC the whole step is tried as one increment. Where '// &
         & 'the first steps of Newton make the metal flow by more than five times the strain '// &
         & 'of first yield, the increment is cut to where it does not, and grows from there.', &
         & 'the first datum of *STATIC is an increment of your own.')
      call add_explanation(list, 'W0531', 'an element is about to fold', &
         & 'The scaled Jacobian of an element at one corner (1 where it is square, 0 where two '// &
         & 'edges lie on one line) has fallen below 0.1. The strains there lose their meaning, '// &
         & 'and the element will soon turn inside out. Where one side has shrunk to a seventh, '// &
         & 'and the one beside it has not, metal has necked or torn, and says so.', &
         & 'a mesh made for the deformed shape, finer where the body turns round an edge.')
   end subroutine theory_limits

   !> Energies, slow motion, and what a release frees.
   subroutine energies(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0558', 'second-order faces are coarse for the tool', &
         & 'The force of a mid-side node acts on the ends of its edge too, and its contact is '// &
         & 'that of the mean gap by those parts. Opposite a curved tool this closes while the '// &
         & 'node stands off by up to two fifths of the gaps at the ends: the tool is met too '// &
         & 'early. With many nodes in contact that matters at the rim alone; with few, the '// &
         & 'force is wrong. Forces times such gaps are more than a tenth of the work done.', &
         & 'finer faces of the slave where it meets the tool, or first-order elements.')
      call add_explanation(list, 'W0530', 'energies do not balance', &
         & 'The work of loads and prescribed displacements differs from stored energy, plastic '// &
         & 'work and friction by more than a hundredth (three of elastic bodies), and by more '// &
         & 'than the trapezoidal rule over such increments misses by the bend of the forces or '// &
         & 'by points that close and open. What a body loses that leaps to another equilibrium '// &
         & 'looks so. The increment that lost most is named.', &
         & 'smaller increments; compare energy.* in the history.')
      call add_explanation(list, 'N0517', 'slow motion found an equilibrium', &
         & 'The path of equilibria turned back, as where a node of a bent sheet leaves a tool: '// &
         & 'no equilibrium lies next to the last one, however small the increment. '// &
         & 'Newton alone finds none there. The run follows an artificial slow motion from the '// &
         & 'last equilibrium until Newton ends it in the next one, as exact as any other. '// &
         & 'What is neither stored nor dissipated on the way is set free, in a real part as '// &
         & 'sound and speed. `.cvg` has the lines `slow motion`.', &
         & 'nothing; a finer mesh or a pad where the part should not jump.')
      call add_explanation(list, 'W0517', 'jumps set much of the work free', &
         & 'As N0517, but more than a twentieth of the work went into jumps: there are several '// &
         & 'equilibria, and inertia or another mesh may choose another one.', &
         & 'a finer mesh where the sheet bends; what holds it there in the shop, as a pad; '// &
         & 'smaller increments.')
      call add_explanation(list, 'W0532', 'artificial work is not small', &
         & 'A body that nothing holds for a while has no equilibrium that tells where it goes: '// &
         & 'artificial supports and soft springs lead it until contact holds it. What loads do '// &
         & 'on that way, and what friction should have taken of a body that they pulled over '// &
         & 'its bound, is stored nowhere. It is energy.artificial in the history and the JSON, '// &
         & 'and more than a hundredth of the work of the run here: where the body ends may be '// &
         & 'the doing of these holds if friction or flow remembers the way.', &
         & 'smaller increments; drive the body by displacement until it touches, or hold it.')
      call add_explanation(list, 'W0514', 'the elastic slip is not small beside the slips', &
         & 'A penalty pair whose deck gives no elastic slip takes 0.5 % of a facet. Here '// &
         & 'nothing slips much farther than that, so that zones of stick and slip mix.', &
         & 'use DIRECT, which sticks exactly, or give ELASTIC SLIP= on *FRICTION.')
   end subroutine energies

   !> Supports and constraints.
   subroutine supports(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'W0403', 'contact forces are not unique', &
         & 'Some contact points are held twice: by a support or by another contact. The '// &
         & 'displacement is '// &
         & 'unique, the split of the forces among them is not; the one of least norm is given.', &
         & 'do not fix slave nodes along the contact normal, and list a pair of surfaces once.')
      call add_explanation(list, 'N0409', 'supports bear what contact would', &
         & 'Supports or a rigid body hold slave nodes along the normal of a tool or a mesh '// &
         & 'that is held there, too: no displacement that is solved for changes their gaps '// &
         & 'or tells a contact force. The nodes have none, nor friction; the supports bear it.', &
         & 'leave them out of the slave surface, or out of the support.')
      call add_explanation(list, 'W0409', 'a slave node is held twice', &
         & 'Supports hold a slave node along its contact normal, and the master opposite too, '// &
         & 'or a tie and another pair hold it at once. Its contact force is then not unique: '// &
         & 'supports carry what they can, the rest is shared in the way of least norm.', &
         & 'leave the node out of the support or out of the slave surface.')
      call add_explanation(list, 'E0506', 'supports press a slave node into its master', &
         & 'The node and the master opposite are both prescribed along the contact normal, so '// &
         & 'that they meet whatever contact does: no force can open the penetration. Where '// &
         & 'they touch without one, as at the end of a belt that is led round its drum, '// &
         & 'nothing determines the pressure.', &
         & 'leave the direction of the normal out of the support of the node, stop the tool '// &
         & 'before it gets there, or take the node out of the slave surface.')
      call add_explanation(list, 'E0507', 'supports tear a tie', &
         & 'A slave node of a tie and the master at the same place are both prescribed, with '// &
         & 'different values: no force of the tie can close what supports open.', &
         & 'give both sides the same displacement, or leave one of them out of the supports.')
      call add_explanation(list, 'W0410', 'supports move the sides of a tie apart', &
         & 'A slave node of a tie and the held nodes of the master near it are prescribed with '// &
         & 'different values. The tie leaves the node to its support there: along this '// &
         & 'direction the two sides part at the node.', &
         & 'give both sides the same displacement, or leave one of them out of the supports.')
   end subroutine supports

   !> Runs in parts, on meshes that are made anew.
   subroutine parts(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0620', 'a run that is remeshed needs a mesher', &
         & '*REMESH makes meshes by libraries of Python; the executable alone has none. '// &
         & 'Elements that separate by *DAMAGE, CRITICAL are taken out there too.', &
         & 'run the deck by the command of the Python package (pip install lopin[remesh]). A '// &
         & 'part of a run that was remeshed is a deck of its own, which the executable runs.')
      call add_explanation(list, 'E0621', 'something that a new mesh cannot carry', &
         & 'Loads or displacements on nodes that a remesh takes away, materials whose memory '// &
         & 'belongs to the first mesh, heat, ties, and surfaces in contact with themselves.', &
         & 'load a tool or a surface, or leave *REMESH out.')
      call add_explanation(list, 'E0622', 'the accuracy asked for is not met', &
         & 'QUANTITY of *LOPIN is not known within TARGET ERROR: the mesh that it would take '// &
         & 'is above the limit, or the number has no limit at all, as the pressure at an edge.', &
         & 'the message says what was reached and what would meet it; the runs made on the way '// &
         & 'are kept.')
   end subroutine parts

   !> Result files, checkpoints and memory.
   subroutine files(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0601', 'the folder of results cannot be used', &
         & 'The folder cannot be made, or holds the unfinished run of another deck.', &
         & 'give another folder with -o, or --overwrite.')
      call add_explanation(list, 'E0602', 'a result file cannot be written', &
         & 'The message says which and why: a full disk, a quota, a limit of file sizes '// &
         & '(ulimit -f), rights, a link that is not followed, a device that fails. Every '// &
         & 'write, sync and close is asked how it went. Files that were written are whole up '// &
         & 'to the increment before, and so is the checkpoint.', &
         & 'mend the cause; the same command with --resume then goes on from the checkpoint.')
      call add_explanation(list, 'E0603', 'a file that Lopin did not write is in the way', &
         & 'Lopin never overwrites or removes files of others.', &
         & 'move the file, or give another folder with -o.')
      call add_explanation(list, 'E0604', 'a checkpoint cannot be gone on from', &
         & 'job.rst is cut short, damaged, not a checkpoint, of another version of Lopin, or '// &
         & 'of another deck: only the deck that wrote it, with the files that it includes, its '// &
         & 'STL files and the same --solver, goes on to the same bits.', &
         & 'restore what has changed, or run the deck from its beginning, without --resume.')
      call add_explanation(list, 'E0605', 'the run was interrupted', &
         & 'Ctrl-C (SIGINT), SIGTERM, SIGHUP or SIGXCPU: answered after the iteration in hand, '// &
         & 'also where attempts fail. The state of the last increment that was accepted is '// &
         & 'kept. A second signal ends the run at '// &
         & 'once; then the last checkpoint counts.', &
         & 'the same command with --resume goes on to the bits of a run without interruption.')
      call add_explanation(list, 'E0606', 'a result file is shorter than when the checkpoint '// &
         & 'was written', &
         & 'A run that goes on cuts its files to what they were at the checkpoint and appends '// &
         & 'to them; this one was removed, replaced or cut.', &
         & 'run the deck from its beginning, without --resume.')
      call add_explanation(list, 'E0607', 'another run is writing into this folder', &
         & 'Two runs of one job would mix their files. The lock belongs to a process, and '// &
         & 'ends with it: a file job.lock that a killed run left behind locks nobody out.', &
         & 'wait until the other run has ended, or give another folder with -o.')
      call add_explanation(list, 'E0608', 'the terminal, pipe or file of the output cannot be '// &
         & 'written to', &
         & 'What a command prints could not be written: a full disk behind >, say. A run goes '// &
         & 'on to its end all the same; its results are in their folder. A reader who left '// &
         & '(lopin doc --all | head) gives the same exit code without a message.', &
         & 'free space, or let the output go elsewhere.')
      call add_explanation(list, 'N0604', 'where a resumed run starts', &
         & 'With --resume a run goes on from job.rst; without one (nothing was accepted yet, '// &
         & 'or the run was finished) it starts from its beginning, so that the same command '// &
         & 'may always be repeated.', &
         & 'nothing.')
      call add_explanation(list, 'E0701', 'a solver cannot take this matrix', &
         & 'Each linear solver takes some classes of matrices: positive definite, symmetric, '// &
         & 'general.', &
         & 'take SOLVER=AUTO.')
      call add_explanation(list, 'E0702', 'not enough memory', &
         & 'The system refuses memory: for the deck, the model, the factor of the matrix or a '// &
         & 'library. The machine has no more, or a limit (ulimit -v) forbids it. Result files '// &
         & 'are whole up to the increment before, and so is the checkpoint.', &
         & 'take a coarser mesh, a machine with more memory or a higher limit; --resume goes on.')
      call add_explanation(list, 'N0706', 'fewer threads than were asked for', &
         & 'The system starts no more threads: a limit of processes (ulimit -u) or of memory.', &
         & 'nothing; or raise the limit, or ask for fewer by --threads.')
   end subroutine files

   !> The command line, and errors of Lopin itself.
   subroutine usage(list)
      type(explanation_type), allocatable, intent(inout) :: list(:)

      call add_explanation(list, 'E0703', 'the solver failed', &
         & 'The library of the linear solver reports a failure that Lopin cannot put into words.', &
         & 'try another solver with --solver, and report the deck.')
      call add_explanation(list, 'E0704', 'no such solver', &
         & 'The word after SOLVER= or --solver names no linear solver of this build; '// &
         & 'MULTIGRID is there only if Lopin was built with PETSc (-DLOPIN_PETSC=ON).', &
         & 'the message lists them.')
      call add_explanation(list, 'E0705', 'a solver cannot condense', &
         & 'The condensed path needs the factor of the contact equations by itself, which '// &
         & 'this solver does not give.', &
         & 'take SOLVER=AUTO, SKYLINE, CHOLMOD or DENSE, or *LOPIN, PATH=NEWTON.')
      call add_explanation(list, 'E0801', 'the command line is wrong', &
         & 'A word or option of the command line is not known, or lacks its value.', &
         & '`lopin --help` lists them all.')
      call add_explanation(list, 'E0802', 'the command is part of the Python package', &
         & 'Plots, reports and conversions are made by the Python package, which brings the '// &
         & 'executable with it.', &
         & 'after ./bootstrap: .venv/bin/lopin; anywhere else: pip install . in the source tree.')
      call add_explanation(list, 'E0803', 'warnings count as errors', &
         & 'The option --strict makes every warning an error.', &
         & 'mend what the warnings say, or leave the option out.')
      call add_explanation(list, 'E0900', 'a defect of Lopin', &
         & 'Something happened that should not be possible.', 'report the deck and the message.')
      call add_explanation(list, 'E0902', 'the selftest failed', &
         & 'The program gives another answer than the closed form: the build or a library is '// &
         & 'broken.', &
         & 'build again, and report the output of `lopin info` and `lopin selftest`.')
      call add_explanation(list, 'E0901', 'the contact problem broke down', &
         & 'The contact solver met numbers that cannot occur.', 'report the deck and the message.')
   end subroutine usage
end module lopin_explain_run
