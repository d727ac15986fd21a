!> What the solids of a section are made of, from the model.
module lopin_section_properties
   use lopin_model, only : model_type
   use lopin_solids, only : solid_section_type
   use lopin_flow_curve, only : flows
   implicit none
   private
   public :: sections_of

contains

   !> Sections with the properties of their materials.
   function sections_of(model) result(section)
      type(model_type), intent(in) :: model
      type(solid_section_type) :: section(size(model%section))
      integer :: i

      do i = 1, size(section)
         section(i)%formulation = model%section(i)%formulation
         section(i)%thickness = model%section(i)%thickness
         associate (material => model%material(model%section(i)%material))
            section(i)%young = material%young
            section(i)%poisson = material%poisson
            section(i)%green = material%green
            section(i)%neo_hooke = material%has_neo_hooke
            section(i)%c10 = material%c10
            section(i)%d1 = material%d1
            section(i)%flow = material%flow
            if (allocated(material%plastic) .and. flows(material%flow)) then
               allocate (section(i)%plastic, source=material%plastic)
               section(i)%plastic%axes = model%section(i)%axes
            end if
            section(i)%expansion = material%expansion
            section(i)%heated = acts_on(model, i)
         end associate
      end do
   end function sections_of

   !> Temperatures or stresses of the start act on a section.
   pure logical function acts_on(model, section) result(acts)
      type(model_type), intent(in) :: model
      integer, intent(in) :: section
      integer :: s

      acts = .false.
      do s = 1, size(model%step)
         if (allocated(model%step(s)%temperature)) acts = acts &
            & .or. size(model%step(s)%temperature) > 0
      end do
      acts = acts .and. model%material(model%section(section)%material)%has_expansion
      if (allocated(model%initial_stress)) acts = acts &
         & .or. any(model%mesh%section(model%initial_stress%element) == section)
      if (allocated(model%initial_state)) acts = acts &
         & .or. any(model%mesh%section(model%initial_state%element) == section)
   end function acts_on
end module lopin_section_properties
