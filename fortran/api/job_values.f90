!> What an open run holds between two increments, as tables that a caller can put on another mesh.
module lopin_job_values
   use lopin_kinds, only : wp
   use lopin_job, only : running_type
   use lopin_recorder, only : recorder_type
   use lopin_recorder_memory, only : memory_recorder_type
   use lopin_model, only : model_type
   use lopin_point_states, only : states_of_points
   use lopin_kept_memory, only : memory_of_points
   use lopin_damage_criteria, only : damage_names
   use lopin_damage, only : damage_kinds, mean_damage
   use lopin_tool, only : foot_type, project_moved
   use lopin_placed_tool, only : placed_tool_type, place_tool
   implicit none
   private
   public :: is_of_open_run, read_open_run, read_memory, job_tool_feet

contains

   !> Whether a result is one of an open run alone.
   pure logical function is_of_open_run(name)
      character(len=*), intent(in) :: name
      is_of_open_run = index(name, 'STATE OF ') == 1
   end function is_of_open_run

   !> A table of an open run by its name; not allocated if it has none.
   subroutine read_open_run(running, model, name, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(inout) :: table(:, :)

      if (.not. running%opened) return
      select case (name)
      case ('STATE OF POINTS')
         call job_points(running, model, table)
      case ('STATE OF MEMORY')
         if (running%run%scene%accepted%solids%in_use) call memory_of_points( &
            & running%run%scene%accepted%solids, model, table)
      case ('STATE OF DAMAGE')
         call job_damage(running, model, table)
      case ('STATE OF CONTACT')
         call job_tractions(running, model, table)
      case ('STATE OF CLOCK')
         call job_clock(running, table)
      case ('STATE OF MOTION')
         call job_motion(running, model, table)
      case ('STATE OF FORCES')
         call job_forces(running, model, table)
      end select
   end subroutine read_open_run

   !> A result that a recorder keeps.
   subroutine read_memory(recorder, name, index, reals, integers)
      class(recorder_type), intent(in) :: recorder
      character(len=*), intent(in) :: name
      integer, intent(in) :: index               !! increment from 1
      real(wp), allocatable, intent(inout) :: reals(:, :)
      integer, allocatable, intent(inout) :: integers(:, :)

      select type (recorder)
      type is (memory_recorder_type)
         call recorder%get_real(name, index, reals)
         call recorder%get_integer(name, index, integers)
      end select
   end subroutine read_memory

   !> Step, total time where it began, time of the step, next increment, 1 at the end of a step,
   !> increments of it.
   subroutine job_clock(running, table)
      type(running_type), intent(in) :: running
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (6, 1)

      associate (scene => running%run%scene, clock => running%run%scene%accepted%clock)
         table = reshape([real(scene%step, wp), clock%start, clock%time, clock%increment, &
            & merge(1.0_wp, 0.0_wp, clock%at_end), real(clock%number, wp)], [6, 1])
         ! The end of a step has moved its start.
         if (clock%at_end) table(2, 1) = clock%start - clock%time
      end associate
   end subroutine job_clock

   !> A column a degree of freedom: label of the node, dof, displacement, the same where the step
   !> began (of prescribed ones), load without amplitude there.
   subroutine job_motion(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (5, ndof)
      integer :: i

      associate (scene => running%run%scene, accepted => running%run%scene%accepted)
         allocate (table(5, scene%dofs%n), source=0.0_wp)
         table(1, :) = model%mesh%node_label(scene%dofs%node(:scene%dofs%n))
         table(2, :) = scene%dofs%dof(:scene%dofs%n)
         table(3, :) = accepted%motion%u
         if (.not. allocated(accepted%loads%from)) return
         do i = 1, size(accepted%loads%from)
            table(4, scene%constraints%dof_of_prescribed(i)) = accepted%loads%from(i)
         end do
         table(5, :) = accepted%loads%before
      end associate
   end subroutine job_motion

   !> A column a degree of freedom: label of the node, dof, force that holds the stresses of the
   !> solids in balance, which is that of loads, supports and contacts.
   subroutine job_forces(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (3, ndof)

      associate (dofs => running%run%scene%dofs)
         allocate (table(3, dofs%n))
         table(1, :) = model%mesh%node_label(dofs%node(:dofs%n))
         table(2, :) = dofs%dof(:dofs%n)
         table(3, :) = running%run%scene%accepted%loads%internal
      end associate
   end subroutine job_forces

   !> What the slave nodes of an open run bear: pair, label of the node, traction (3) [stress], slip
   !> from the stick anchor (3) [length]; not allocated without contact on the present shape.
   subroutine job_tractions(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (8, points)
      integer :: i

      associate (contact => running%run%scene%newton%contact, &
         & state => running%run%scene%accepted%contact)
         if (.not. allocated(contact%node) .or. .not. allocated(state%traction)) return
         allocate (table(8, contact%n))
         do i = 1, contact%n
            table(:2, i) = [contact%pair(i), model%mesh%node_label(contact%node(i))]
            table(3:5, i) = state%traction(:, i)
            table(6:, i) = state%creep(:, i)
         end do
      end associate
   end subroutine job_tractions

   !> The closest points of the tool of a pair where it stands now: gap [length], how far beyond an
   !> open end [length], the point, its normal. Gaps are huge where a tool has no point to offer;
   !> `found` is false if the pair has no analytic tool, or the run is not open.
   subroutine job_tool_feet(running, model, pair, points, foot, found)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      integer, intent(in) :: pair
      real(wp), intent(in) :: points(:, :)     !! (ndim, n) [length]
      real(wp), intent(out) :: foot(:, :)      !! (2 + 2 ndim, n)
      logical, intent(out) :: found
      type(placed_tool_type) :: stand
      type(foot_type) :: near
      integer :: i, d

      foot = 0.0_wp
      d = size(points, 1)
      found = running%opened .and. pair >= 1 .and. pair <= size(model%pair) &
         & .and. d == model%mesh%ndim
      if (found) found = model%surface(model%pair(pair)%master)%tool > 0
      if (.not. found) return
      associate (scene => running%run%scene)
         call place_tool(stand, scene, model, pair, scene%accepted%motion%u)
      end associate
      do i = 1, size(points, 2)
         call project_moved(stand%shape, stand%motion, points(:, i), near)
         foot(1, i) = merge(near%gap, huge(1.0_wp), near%found)
         foot(2, i) = near%overhang
         foot(3:2 + d, i) = near%point(:d)
         foot(3 + d:, i) = near%normal(:d)
      end do
   end subroutine job_tool_feet

   !> Damage of each point, in the order of STATE OF POINTS: a row for each name of a criterion,
   !> then the means.
   subroutine job_damage(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (8, points)
      real(wp), allocatable :: mean(:, :)
      integer, allocatable :: kinds(:)

      associate (scene => running%run%scene, solids => running%run%scene%accepted%solids)
         if (.not. allocated(solids%damage)) return
         call mean_damage(scene%solids, model, scene%accepted%motion%u, solids, mean)
         allocate (kinds, source=damage_kinds(model))
         allocate (table(2*size(damage_names), size(mean, 2)), source=0.0_wp)
         table(kinds, :) = solids%damage(1::2, :)
         table(size(damage_names) + kinds, :) = mean
      end associate
   end subroutine job_damage

   !> What the integration points of an open run hold, as numbers of any mesh
   !> (lopin_point_states); not allocated if they remember nothing.
   subroutine job_points(running, model, table)
      type(running_type), intent(in) :: running
      type(model_type), intent(in) :: model
      real(wp), allocatable, intent(inout) :: table(:, :)   !! (state_rows, points)

      associate (scene => running%run%scene)
         if (scene%accepted%solids%in_use) call states_of_points(scene%solids, model%mesh, &
            & scene%accepted%motion%u, scene%accepted%solids, table)
      end associate
   end subroutine job_points
end module lopin_job_values
