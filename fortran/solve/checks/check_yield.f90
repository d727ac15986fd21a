!> Bodies that would yield, and that the deck computes as elastic.
module lopin_check_yield
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_recover_nonlinear, only : recover_nonlinear
   use lopin_model, only : model_type
   use lopin_recover_stress, only : recover_stress
   use lopin_scene, only : scene_type
   use lopin_repeated_messages, only : warn_once
   use lopin_flow_curve, only : flows
   use lopin_von_mises, only : von_mises
   implicit none
   private
   public :: check_yield

contains

   !> Warn once of each material whose von Mises stress passes its yield stress.
   subroutine check_yield(scene, model, u)
      type(scene_type), intent(inout) :: scene
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: u(:, :)      !! (>= ndim, nnode) accepted displacements [length]
      real(wp), allocatable :: stress(:, :), strain(:, :)
      real(wp) :: share, most(size(model%material))
      integer :: e, k, point, worst(size(model%material))
      logical :: judged(size(model%material))

      judged = [(model%material(k)%yield > 0.0_wp .and. &
         & .not. (scene%newton%in_use .and. flows(model%material(k)%flow)), &
         & k=1, size(model%material))]
      if (.not. any(judged)) return
      if (scene%newton%in_use) then
         call recover_nonlinear(scene%solids, model%mesh, u, scene%accepted%solids, stress, strain)
      else
         call recover_stress(scene%solids, model%mesh, u, stress, strain)
      end if
      most = 1.0_wp
      worst = 0
      do e = 1, model%mesh%nelement
         if (model%mesh%section(e) == 0) cycle
         k = model%section(model%mesh%section(e))%material
         if (.not. judged(k)) cycle
         do point = scene%solids%first_point(e), scene%solids%first_point(e + 1) - 1
            share = von_mises(stress(:, point))/model%material(k)%yield
            if (share <= most(k)) cycle
            most(k) = share
            worst(k) = e
         end do
      end do
      do k = 1, size(worst)
         if (worst(k) == 0) cycle
         call warn_once(scene%log, 'W0508', 'material `'//model%material(k)%name// &
            & '` passes its yield stress in step '//to_text(scene%step)//' (first seen: '// &
            & to_text(most(k), 3)//' times, at element '// &
            & to_text(model%mesh%element_label(worst(k)))//'); it is computed as elastic', &
            & model%material(k)%plastic_at, &
            & help='leave out ONLY=FRICTION of *PLASTIC and PATH=CONDENSED: the stresses are '// &
            & 'wrong where they pass it')
      end do
   end subroutine check_yield
end module lopin_check_yield
