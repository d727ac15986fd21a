!> Ties whose two sides are moved apart by supports: nothing can hold them together.
module lopin_torn_ties
   use lopin_kinds, only : wp
   use lopin_error, only : error_type, error_code, raise
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_constraints, only : expand
   use lopin_contact_points, only : pair_is_tied
   use lopin_initial_gaps, only : may_tie
   use lopin_tie_release, only : held_apart, apart_type
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: refuse_torn_ties, torn_id

   !> No smaller increment helps.
   character(len=*), parameter :: torn_id = 'E0507'

   !> Nodes nearer than this share of a facet are at one place, which cannot go two ways.
   real(wp), parameter :: same_place = 1.0e-3_wp
   !> So near, a motion of the scene that turns about them differs by less than this of its largest.
   real(wp), parameter :: differs = 1.0e-3_wp
   !> Elsewhere a jump beyond this share of the supports' own motion is said, if it is no rounding;
   !> facets farther away than this do not compare.
   real(wp), parameter :: told = 0.05_wp, rounding = 1.0e-6_wp, near = 0.1_wp, mostly = 0.5_wp

contains

   !> Compare the prescribed displacements on both sides of all tied points.
   subroutine refuse_torn_ties(scene, model, prescribed, error)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: prescribed(:)    !! (nprescribed) at the end of the increment
      type(error_type), allocatable, intent(out) :: error
      type(apart_type) :: apart
      real(wp) :: v(scene%supports%neq), u(scene%dofs%n), most, across
      integer :: pair, i, d

      if (.not. allocated(scene%points%released)) return
      if (.not. any(abs(prescribed) > 0.0_wp)) return
      d = model%mesh%ndim
      v = 0.0_wp
      call expand(scene%supports, v, prescribed, u)
      if (turns(scene, model, u)) return
      most = maxval(abs(u))
      do pair = 1, size(model%pair)
         if (.not. pair_is_tied(model, model%pair(pair))) cycle
         do i = scene%points%first(pair), scene%points%first(pair + 1) - 1
            if (.not. may_tie(scene%points, i, model%pair(pair)%adjust)) cycle
            call held_apart(scene%points, model, scene%dofs, scene%supports, i, u, apart)
            if (.not. apart%jump > rounding*most) cycle
            across = dot_product(apart%place, scene%points%normal(:, i))
            across = norm2(apart%place - across*scene%points%normal(:, i))/scene%points%size(i)
            if (apart%farthest <= same_place*scene%points%size(i) &
               & .and. apart%jump > differs*most) then
               call raise(error, error_code%not_converged, torn_id, &
                  & describe(scene, model, i, apart)//': nothing can hold them together', &
                  & model%pair(pair)%at, help=remedy(scene, model, i, apart))
               return
            end if
            if (apart%share > mostly .and. across <= near .and. apart%jump > told*apart%moved) &
               & call warn_once(scene%log, 'W0410', describe(scene, model, i, apart)// &
               & ': the tie does not hold there', &
               & model%pair(pair)%at, help=remedy(scene, model, i, apart))
         end do
      end do
   end subroutine refuse_torn_ties

   !> A rigid body of nodes turns under NLGEOM: its nodes go on circles, not by the constraints.
   pure logical function turns(scene, model, u)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:)
      integer :: body, k

      turns = .false.
      if (.not. scene%newton%nlgeom) return
      do body = 1, size(model%rigid_body)
         if (size(model%rigid_body(body)%node) == 0) cycle
         do k = 4, 6
            associate (id => scene%dofs%id(k, model%rigid_body(body)%reference))
               if (id > 0) turns = turns .or. abs(u(max(id, 1))) > 0.0_wp
            end associate
         end do
      end do
   end function turns

   function describe(scene, model, i, apart) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(apart_type), intent(in) :: apart
      character(len=:), allocatable :: text

      associate (pair => model%pair(scene%points%pair(i)))
         text = 'node '//to_text(model%mesh%node_label(scene%points%node(i)))// &
            & ' is tied by pair ('//model%surface(pair%slave)%name//', '// &
            & model%surface(pair%master)%name// &
            & '), and supports move it and the master opposite apart by '// &
            & to_text(apart%jump, 4)//' along direction '//to_text(dof_of(apart))
      end associate
   end function describe

   function remedy(scene, model, i, apart) result(text)
      type(scene_type), intent(in) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: i
      type(apart_type), intent(in) :: apart
      character(len=:), allocatable :: text
      integer :: k

      text = 'give both sides the same displacement, or leave the node out of its support'
      associate (held => model%step(scene%step)%prescribed)
         do k = 1, size(held)
            if (held(k)%node /= scene%points%node(i) .or. held(k)%dof /= dof_of(apart)) cycle
            text = text//' on line '//to_text(held(k)%at%line)
            return
         end do
      end associate
   end function remedy

   pure integer function dof_of(apart)
      type(apart_type), intent(in) :: apart
      dof_of = maxloc(abs(apart%direction), 1)
   end function dof_of
end module lopin_torn_ties
