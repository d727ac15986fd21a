!> Second-order faces that are coarse beside the curvature of what they touch.
!>
!> The row of a mid-side node pushes the ends of its edge too, the other way, and its gap is the
!> mean of their gaps by those parts. Opposite a curved tool that mean is zero while the node itself
!> stands off, by two fifths of the gaps at the ends: the tool is met so much too early. Where many
!> nodes press, that is so at the rim alone. Forces times these ways, beside the work that has been
!> done, bound what of the force is wrong: W = F z/(n + 1) where F grows as z^n, so dF/F = n dz/z is
!> n/(n + 1) of F dz/W.
module lopin_coarse_faces
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_model, only : model_type
   use lopin_row_samples, only : has_inner
   use lopin_scene, only : scene_type
   use lopin_present_gaps, only : gap_of, row_gap_of
   use lopin_repeated_messages, only : warn_once
   implicit none
   private
   public :: check_coarse_faces

   !> Forces times ways beside the work done.
   real(wp), parameter :: most = 0.1_wp

   !> What a pair has of it.
   type :: stand_off_type
      real(wp) :: work = 0.0_wp                !! sum of force times way [energy]
      real(wp) :: farthest = 0.0_wp            !! way of one node [length]
      integer :: node = 0
   end type stand_off_type

contains

   !> At the end of a step: pairs whose mid-side nodes press from afar.
   subroutine check_coarse_faces(scene, model, whole)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: whole            !! work done so far [energy]
      type(stand_off_type) :: pair(size(model%pair))
      integer :: i, row

      if (.not. whole > 0.0_wp) return
      if (scene%newton%in_use) then
         associate (c => scene%newton%contact)
            do i = 1, c%n
               if (c%status(i) > 0 .and. .not. c%enforcement(i)%tied) call add(pair(c%pair(i)), &
                  & c%node(i), c%pressure(i)*c%weight(i), c%trial(i)%beyond)
            end do
         end associate
      else
         do row = 1, scene%rows%nnormal
            i = scene%rows%point(row)
            if (scene%rows%tied(row) .or. .not. scene%answer%force(row) > 0.0_wp &
               & .or. .not. scene%points%share(i) > 0.0_wp) cycle
            if (has_inner(scene%points, i)) cycle
            call add(pair(scene%points%pair(i)), scene%points%node(i), scene%answer%force(row), &
               & row_gap_of(scene, model, i) - gap_of(scene, model, i))
         end do
      end if
      do i = 1, size(pair)
         if (pair(i)%work > most*whole) call say(scene, model, i, pair(i), whole)
      end do
   end subroutine check_coarse_faces

   pure subroutine add(self, node, force, beyond)
      type(stand_off_type), intent(inout) :: self
      integer, intent(in) :: node
      real(wp), intent(in) :: force            !! [force]
      real(wp), intent(in) :: beyond           !! mean gap of the row less the node's [length]

      if (.not. abs(beyond) > 0.0_wp) return
      self%work = self%work + abs(force*beyond)
      if (abs(beyond) <= abs(self%farthest)) return
      self%farthest = -beyond
      self%node = node
   end subroutine add

   subroutine say(scene, model, number, pair, whole)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      integer, intent(in) :: number
      type(stand_off_type), intent(in) :: pair
      real(wp), intent(in) :: whole            !! [energy]

      associate (p => model%pair(number))
         call warn_once(scene%log, 'W0558', 'second-order faces of pair ('// &
            & model%surface(p%slave)%name//', '//model%surface(p%master)%name// &
            & ') are coarse for the curvature that they meet: in step '//to_text(scene%step)// &
            & ' node '//to_text(model%mesh%node_label(pair%node))//' is pressed with '// &
            & to_text(pair%farthest, 3)//' between it and the tool; such gaps, times their '// &
            & 'forces, are '//to_text(100.0_wp*pair%work/whole, 2)//' % of all work, and the '// &
            & 'force may be wrong by as much', p%at, &
            & help='finer faces of the slave where it meets the tool, or first-order elements')
      end associate
   end subroutine say
end module lopin_coarse_faces
