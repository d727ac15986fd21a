!> Slave nodes that supports press into a master that cannot give way, on the nonlinear path.
!>
!> Nothing can open such a penetration: every iteration raises the pressure, and beside a pressure
!> without bounds the rest looks like rounding. Nor does anything determine the pressure of a point
!> whose gap has no slope in any displacement that is solved for, as that of a rigid end that goes
!> round a drum, or of a node on a plane of symmetry that is a tool, too: it has no row, and the
!> supports bear what there is.
module lopin_held_points
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_scene, only : scene_type
   use lopin_local_matrix, only : local_matrix_type
   use lopin_repeated_messages, only : note_once
   implicit none
   private
   public :: refuse_held_points, name_held_point, held_id, find_idle_points, tell_idle_points, &
      & find_idle_rows, wake_idle_rows

   !> A failure that no smaller increment can avoid.
   character(len=*), parameter :: held_id = 'E0506'

   !> Penetration beyond this share of a facet is no rounding; components of a normal that count.
   real(wp), parameter :: penetrates = 1.0e-6_wp, counts = 1.0e-6_wp
   !> All directions.
   real(wp), parameter :: everywhere(3, 3) = reshape([real(wp) :: 1, 0, 0, 0, 1, 0, 0, 0, 1], &
      & [3, 3])
   !> Pressures of held points this many times all others are none.
   real(wp), parameter :: stray = 1.0e3_wp

contains

   !> Which points no displacement that is solved for can open or close.
   subroutine find_idle_points(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      do i = 1, scene%newton%contact%n
         scene%newton%contact%idle(i) = is_idle(scene, model, i)
      end do
   end subroutine find_idle_points

   !> Touching points whose gap no displacement that is solved for changes: they get no row.
   subroutine find_idle_rows(scene, model, found)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      logical, intent(out) :: found
      integer :: k, i

      found = .false.
      associate (c => scene%newton%contact)
         do k = 1, c%nlocal
            i = c%local(k)%point
            if (i == 0) cycle
            if (c%idle(i) .or. c%status(i) == 0 .or. c%first_row(i) == 0) cycle
            if (c%enforcement(i)%tied) cycle
            associate (interaction => model%interaction(model%pair(c%pair(i))%interaction))
               if (.not. interaction%method%is_exact()) cycle
            end associate
            if (.not. has_no_slope(scene, c%local(k), c%normal(:, i))) cycle
            c%idle(i) = .true.
            found = .true.
         end do
      end associate
   end subroutine find_idle_rows

   !> Such points that have gone into their masters since are looked at again.
   subroutine wake_idle_rows(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (.not. c%idle(i) .or. c%facet(i) == 0) cycle
            if (c%gap(i) < -penetrates*c%size(i)) c%idle(i) = is_idle(scene, model, i)
         end do
      end associate
   end subroutine wake_idle_rows

   !> The gap of a closed row has no slope in any free equation.
   pure logical function has_no_slope(scene, local, normal)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), intent(in) :: local
      real(wp), intent(in) :: normal(3)
      real(wp) :: slope(local%nu), most
      integer :: k, a, d

      d = count(local%dof > scene%dofs%n)
      if (allocated(local%flat_row)) then
         slope = matmul(normal(:d), local%flat_row)
      else
         slope = matmul(normal(:d), local%k(local%nu + 1:local%nu + d, :local%nu))
      end if
      has_no_slope = local%nu > 0 .and. d > 0
      if (.not. has_no_slope) return
      most = maxval([(abs(slope(k))/unit_of(scene, local%dof(k)), k=1, local%nu)])
      has_no_slope = most > 0.0_wp
      do k = 1, local%nu
         if (.not. has_no_slope) return
         if (.not. abs(slope(k)) > counts*most*unit_of(scene, local%dof(k))) cycle
         do a = scene%constraints%first(local%dof(k)), scene%constraints%first(local%dof(k) + 1) - 1
            associate (equation => scene%constraints%equation(a))
               has_no_slope = has_no_slope .and. .not. abs(slope_in(scene, local, slope, &
                  & equation)) > counts*most*unit_of(scene, &
                  & scene%constraints%dof_of_equation(equation))
            end associate
         end do
      end do
   end function has_no_slope

   !> What a slope in a dof is beside that in a displacement: 1, or the size of the bodies.
   pure real(wp) function unit_of(scene, dof) result(unit)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: dof

      unit = 1.0_wp
      if (scene%dofs%dof(dof) > 3) unit = scene%bodies%length
   end function unit_of

   !> Slope of the gap in one free equation.
   pure real(wp) function slope_in(scene, local, slope, equation) result(along)
      type(scene_type), intent(in) :: scene
      type(local_matrix_type), intent(in) :: local
      real(wp), intent(in) :: slope(:)         !! (nu) in the dofs [-]
      integer, intent(in) :: equation
      integer :: k, a

      along = 0.0_wp
      associate (c => scene%constraints)
         do k = 1, local%nu
            do a = c%first(local%dof(k)), c%first(local%dof(k) + 1) - 1
               if (c%equation(a) == equation) along = along + slope(k)*c%coefficient(a)
            end do
         end do
      end associate
   end function slope_in

   !> Of exact contact with a tool: with penalties the penetration gives a pressure.
   pure logical function is_idle(scene, model, i)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                 !! point

      is_idle = .false.
      associate (c => scene%newton%contact)
         if (c%enforcement(i)%tied .or. c%masters%of(c%pair(i))%tool == 0) return
         associate (interaction => model%interaction(model%pair(c%pair(i))%interaction))
            if (.not. interaction%method%is_exact()) return
         end associate
         is_idle = node_held(scene, model, c%node(i), everywhere) .and. &
            & tool_held(scene, model, c%masters%of(c%pair(i))%body, everywhere)
      end associate
   end function is_idle

   !> Say of which touching points supports bear the contact force.
   subroutine tell_idle_points(scene, model)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer :: pair, first, count_of, i

      do pair = 1, size(model%pair)
         count_of = 0
         first = 0
         associate (c => scene%newton%contact)
            do i = 1, c%n
               if (c%pair(i) /= pair .or. .not. c%idle(i) .or. c%facet(i) == 0) cycle
               if (c%gap(i) > penetrates*c%size(i)) cycle
               count_of = count_of + 1
               if (first == 0) first = c%node(i)
            end do
         end associate
         if (count_of == 0) cycle
         call note_once(scene%log, 'N0409', to_text(count_of)//' slave nodes of '// &
            & model%surface(model%pair(pair)%slave)%name//' touch '// &
            & model%surface(model%pair(pair)%master)%name//' where supports hold them, the '// &
            & 'first is '//to_text(model%mesh%node_label(first))//': they have no pressure, '// &
            & 'the supports bear it', model%pair(pair)%at)
      end do
   end subroutine tell_idle_points

   !> What supports press into its master in a trial that is in balance. One that is not shows where
   !> a node has gone along its master as little as it shows the normal there: while a smaller
   !> increment can be tried, it tells of nodes alone whose places nothing but supports decide.
   subroutine refuse_held_points(scene, model, error, balanced)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in), optional :: balanced        !! absent: it is
      real(wp) :: most
      logical :: pressed, sure
      integer :: i

      sure = .true.
      if (present(balanced)) sure = balanced .or. .not. scene%may_cut
      most = determined_pressure(scene, model)
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%facet(i) == 0 .or. (c%status(i) == 0 .and. .not. c%idle(i))) cycle
            if (c%enforcement(i)%tied) cycle
            pressed = -c%gap(i) > penetrates*c%size(i)
            if (.not. (pressed .or. c%pressure(i) > stray*most)) cycle
            associate (pair => model%pair(c%pair(i)))
               if (.not. model%interaction(pair%interaction)%method%is_exact()) cycle
               if (.not. (sure .or. stands(scene, model, i))) cycle
               if (.not. c%idle(i)) then
                  if (.not. node_held(scene, model, c%node(i), c%normal(:, i:i))) cycle
                  if (.not. master_held(scene, model, i, c%normal(:, i:i))) cycle
               end if
               if (.not. pressed) then
                  call raise(error, error_code%not_converged, held_id, 'node '// &
                     & to_text(model%mesh%node_label(c%node(i)))//' of pair ('// &
                     & model%surface(pair%slave)%name//', '//model%surface(pair%master)%name// &
                     & ') is held along its contact normal by supports, and so is the master '// &
                     & 'opposite: nothing determines its pressure', pair%at, help='take it out '// &
                     & 'of the slave surface '//model%surface(pair%slave)%name)
                  return
               end if
               call raise(error, error_code%not_converged, held_id, 'node '// &
                  & to_text(model%mesh%node_label(c%node(i)))//' of pair ('// &
                  & model%surface(pair%slave)%name//', '//model%surface(pair%master)%name// &
                  & ') is overconstrained: supports hold it along its contact normal, and the '// &
                  & 'master opposite, and they press it into its master by '// &
                  & to_text(-c%gap(i), 4)//': no contact force can open that', pair%at, &
                  & help='leave the direction of the normal out of its support, or take it '// &
                  & 'out of the slave surface '//model%surface(pair%slave)%name)
               return
            end associate
         end do
      end associate
   end subroutine refuse_held_points

   !> The largest pressure of points that are not both closed and held; huge: there are none.
   pure real(wp) function determined_pressure(scene, model) result(most)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer :: i

      most = 0.0_wp
      associate (c => scene%newton%contact)
         do i = 1, c%n
            if (c%pressure(i) <= most) cycle
            if (node_held(scene, model, c%node(i), c%normal(:, i:i))) cycle
            most = c%pressure(i)
         end do
      end associate
      if (.not. most > 0.0_wp) most = huge(1.0_wp)/stray
   end function determined_pressure

   !> Where iterations failed for a node that supports press into its master, that is the message.
   subroutine name_held_point(scene, model, error)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(inout) :: error
      type(error_type), allocatable :: cause

      call refuse_held_points(scene, model, cause, balanced=.false.)
      if (allocated(cause)) call move_alloc(cause, error)
   end subroutine name_held_point

   !> No free equation moves the node along directions, whatever the axes of its supports are.
   pure logical function node_held(scene, model, node, directions) result(held)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      real(wp), intent(in) :: directions(:, :) !! (3, n) unit; one of no length is not held
      integer :: id(3), k, n, a

      id = 0
      id(:model%mesh%ndim) = scene%dofs%id(:model%mesh%ndim, node)
      held = .true.
      do n = 1, size(directions, 2)
         held = held .and. any(abs(directions(:, n)) > 0.0_wp)
         do k = 1, 3
            if (.not. held .or. id(k) == 0) cycle
            do a = scene%constraints%first(id(k)), scene%constraints%first(id(k) + 1) - 1
               associate (equation => scene%constraints%equation(a))
                  held = held .and. .not. abs(way_in(scene, id, directions(:, n), equation)) &
                     & > counts*unit_of(scene, scene%constraints%dof_of_equation(equation))
               end associate
            end do
         end do
      end do
   end function node_held

   !> How far one free equation moves a node along a direction.
   pure real(wp) function way_in(scene, id, direction, equation) result(way)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: id(3)             !! dofs; 0: there is none
      real(wp), intent(in) :: direction(3)
      integer, intent(in) :: equation
      integer :: k, a

      way = 0.0_wp
      do k = 1, 3
         if (id(k) == 0) cycle
         do a = scene%constraints%first(id(k)), scene%constraints%first(id(k) + 1) - 1
            if (scene%constraints%equation(a) == equation) way = way + direction(k) &
               & *scene%constraints%coefficient(a)
         end do
      end do
   end function way_in

   pure logical function dof_held(scene, dof) result(held)
      type(scene_type), intent(in) :: scene
      integer, intent(in) :: dof               !! 0: there is none
      held = dof == 0
      if (.not. held) held = scene%constraints%first(dof + 1) == scene%constraints%first(dof)
   end function dof_held

   !> No free equation moves a tool along directions, or turns it.
   pure logical function tool_held(scene, model, body, directions) result(held)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: body              !! that moves it; 0: it is fixed
      real(wp), intent(in) :: directions(:, :) !! (3, n)
      integer :: k

      held = .true.
      if (body == 0) return
      associate (reference => model%rigid_body(body)%reference)
         held = node_held(scene, model, reference, directions)
         do k = 4, 6
            held = held .and. dof_held(scene, scene%dofs%id(k, reference))
         end do
      end associate
   end function tool_held

   !> Supports alone decide the place of a point and of what lies opposite.
   pure logical function stands(scene, model, i)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                 !! point

      stands = node_held(scene, model, scene%newton%contact%node(i), everywhere)
      if (stands) stands = master_held(scene, model, i, everywhere)
   end function stands

   !> The tool, or the nodes of the facet opposite, have no free way along directions.
   pure logical function master_held(scene, model, i, directions) result(held)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i                 !! point
      real(wp), intent(in) :: directions(:, :) !! (3, n)
      integer :: f, k

      associate (c => scene%newton%contact, master => &
         & scene%newton%contact%masters%of(scene%newton%contact%pair(i)))
         held = .true.
         if (master%tool > 0) then
            held = tool_held(scene, model, master%body, directions)
            return
         end if
         f = c%facet(i)
         if (f > master%surface%facets%n) f = 0
         do k = 1, merge(master%surface%facets%nnode(max(f, 1)), 0, f > 0)
            held = held .and. node_held(scene, model, master%surface%facets%node(k, f), &
               & directions)
         end do
      end associate
   end function master_held
end module lopin_held_points
